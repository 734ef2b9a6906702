#include "chain/studies/law_quantities.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/staged_laws.hpp"
#include "model/student.hpp"
#include "predict/bands.hpp"

namespace grainlaw::chain {
namespace {

/// The published law, of which packing c has moved parameter i by 1 % of its value times sin(i + 2 c).
fit::Calibration calibrated(int packings) {
  fit::Calibration c = fit::nothing_known();
  c.law.parameters = published_parameters();
  c.law.parameters.anisotropy.a2 = 1.18;
  fit::widen(c.errors.influence, packings);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (name.starts_with("memory") || name == "anisotropy.a0") continue;
    const double value = *fields(c.law.parameters)[i];
    c.law.estimates[i] = {value, 1, Status::fitted, ""};
    c.law.estimates[i].degrees_of_freedom = packings - 1;
    for (int k = 0; k < packings; ++k)
      c.errors.influence(static_cast<Eigen::Index>(i), k) = 0.01 * value * std::sin(static_cast<double>(i) + 2 * k);
  }
  c.law.covariance = c.errors.covariance();
  return c;
}

TEST(LawQuantities, ErrorsAreThoseOfTheParametersTimesTheSlope) {
  const fit::Calibration c = calibrated(3);
  const auto quantities = law_quantities(c, {0.70, 0.80}, 3);
  ASSERT_EQ(quantities.size(), 13u);
  EXPECT_EQ(quantities[0].name, "P_star@0.70");
  EXPECT_EQ(quantities[0].values(0), c.law.parameters.isotropic.P_star(0.70));
  const StudyQuantity& nu_c = quantities.back();
  const auto row = static_cast<Eigen::Index>(parameter_index("pressure.nu_c"));
  EXPECT_FALSE(nu_c.in_error);
  EXPECT_NEAR((nu_c.influence - c.errors.influence.row(row)).norm(), 0, 1e-9);
  // s_max = Q_limit + Q_c exp(...): linear in these two; the third by its derivative
  const StudyQuantity& s_max = quantities[2];
  ASSERT_EQ(s_max.name, "s_max@0.70");
  const auto at = [&](const char* name) {
    return Eigen::RowVectorXd(c.errors.influence.row(static_cast<Eigen::Index>(parameter_index(name))));
  };
  const auto& Q = c.law.parameters.stress_ratio_max;
  const double y = 0.70 / c.law.parameters.shear_nu_c - 1, e = std::exp(-Q.alpha * y);
  const Eigen::RowVectorXd expected = at("stress_ratio_max.Q_limit") + e * at("stress_ratio_max.Q_c") -
                                      Q.Q_c * y * e * at("stress_ratio_max.alpha") +
                                      Q.Q_c * Q.alpha * e * (y + 1) / c.law.parameters.shear_nu_c * at("shear.nu_c");
  EXPECT_NEAR((s_max.influence - expected).norm(), 0, 1e-8 * expected.norm());
}

TEST(LawQuantities, PredictionsHaveTheErrorOfTheirBands) {
  const fit::Calibration c = calibrated(4);
  const Path path{0.70, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, 0.80}}};
  ASSERT_EQ(calibrated_rungs(c.law).back(), Rung::evolution);
  const auto quantities = predicted_quantities(c, path, Rung::evolution, 4, {});
  const auto segments = resolve(path);
  const predict::Prediction prediction =
      predict::predict_with_bands(Rung::evolution, c.law, segments, predict::state_from_law(c.law.parameters, path.nu),
                                  true, predict::uniform_points(segments, 100), {});
  ASSERT_EQ(quantities.size(), 3u);
  for (Eigen::Index i = 1; i < quantities[0].values.size(); ++i) {
    const predict::PredictedRow& row = prediction.rows[static_cast<std::size_t>(i)];
    EXPECT_EQ(quantities[0].values(i), row.state.P);
    const double t = student_95(3);
    EXPECT_NEAR(t * quantities[0].influence.row(i).norm() / row.mean.P, 1, 1e-9);
    EXPECT_NEAR(t * quantities[1].influence.row(i).norm() / row.mean.s_par, 1, 1e-9);
    EXPECT_NEAR(t * quantities[2].influence.row(i).norm() / row.mean.F_par, 1, 1e-9);
  }
}

TEST(LawQuantities, WhatIsNotIdentifiedIsMissing) {
  fit::Calibration c = calibrated(2);
  c.law.estimates[parameter_index("anisotropy.a2")].status = Status::not_identified;
  EXPECT_EQ(calibrated_rungs(c.law), std::vector{Rung::reduced});
  c.law.estimates[parameter_index("stress_rate.Q_c")].status = Status::not_identified;
  EXPECT_TRUE(calibrated_rungs(c.law).empty());
  for (const StudyQuantity& q : law_quantities(c, {0.70}, 2))
    EXPECT_EQ(std::isnan(q.values(0)), q.name == "beta_s@0.70") << q.name;
}

}  // namespace
}  // namespace grainlaw::chain
