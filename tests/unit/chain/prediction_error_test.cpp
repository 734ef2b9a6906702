#include "chain/planning/prediction_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fit/staged_laws.hpp"
#include "predict/predict.hpp"

namespace grainlaw::chain {
namespace {

/// The published law with errors of `error` times the value of each parameter.
CalibratedLaw law_with_errors(double error) {
  CalibratedLaw c = fit::nothing_known().law;
  c.parameters = published_parameters();
  c.parameters.anisotropy.a2 = 1.18;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (name.starts_with("memory") || name == "anisotropy.a0") continue;
    const double value = *fields(c.parameters)[i], se = error * std::abs(value);
    c.estimates[i] = {value, se, Status::fitted, ""};
    c.estimates[i].degrees_of_freedom = 3;
    c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = se * se;
  }
  return c;
}

Path shear() { return {0.72, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}}; }

/// Rehearsals on four packings: the law's own values, times 1 + `bias` -+ `scatter` for P*; F_par is the law's.
std::vector<TestRecord> rehearsals(const CalibratedLaw& c, double bias, double scatter) {
  const auto segments = resolve(shear());
  const auto law = predict::predict(Rung::evolution, c.parameters, c.coupling, segments,
                                    predict::state_from_law(c.parameters, shear().nu),
                                    predict::uniform_points(segments, 50), {}, {}, {});
  std::vector<TestRecord> tests;
  for (int s = 1; s <= 4; ++s) {
    TestRecord& test = tests.emplace_back();
    test.path = shear();
    for (const predict::PredictedRow& row : law.rows) {
      Observation& o = test.rows.emplace_back();
      o.time = row.eps_dev;
      o.strain = row.strain;
      o.nu = row.nu;
      o.shear_path = row.shear_path;
      o.P_star = row.state.P * (1 + bias + (s % 2 ? scatter : -scatter));
      o.F_par = row.F_par;
    }
  }
  return tests;
}

TEST(PredictionError, IsTheBandsHalfWidth) {
  const PredictionError one = prediction_error(law_with_errors(0.002), shear(), {}),
                        two = prediction_error(law_with_errors(0.004), shear(), {});
  EXPECT_EQ(one.rung, Rung::evolution);
  ASSERT_EQ(one.quantities.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(one.quantities[i].half_width, 0);
    EXPECT_LT(one.quantities[i].half_width, one.quantities[i].largest);
    EXPECT_NEAR(two.quantities[i].half_width, 2 * one.quantities[i].half_width, 1e-9);
    EXPECT_TRUE(std::isnan(one.quantities[i].discrepancy));  // no residuals
  }
  EXPECT_TRUE(std::isnan(prediction_error(law_with_errors(0), shear(), {}).quantities[0].half_width));
}

TEST(PredictionError, APathWithoutShearHasPressureAlone) {
  const Path iso{0.72, Branch::unloading, {{Mode::ISO, direction_of(Mode::ISO), ExtentKind::target_nu, 0.8}}};
  const PredictionError e = prediction_error(law_with_errors(0.002), iso, {});
  ASSERT_EQ(e.quantities.size(), 1u);
  EXPECT_EQ(e.quantities[0].quantity, "P_star");
}

TEST(PredictionError, NothingIsKnownByALawThatCannotPredict) {
  CalibratedLaw c = law_with_errors(0.002);
  c.estimates[parameter_index("anisotropy.a2")].status = Status::not_identified;
  EXPECT_EQ(prediction_error(c, shear(), {}).rung, Rung::reduced);
  c.estimates[parameter_index("stress_rate.Q_c")].status = Status::not_identified;
  const PredictionError e = prediction_error(c, shear(), {});
  ASSERT_EQ(e.quantities.size(), 3u);
  EXPECT_TRUE(std::isnan(e.quantities[0].half_width));
}

TEST(PredictionError, DiscrepancyIsWhatChanceDoesNotExplain) {
  const CalibratedLaw c = law_with_errors(1e-7);  // a band of nearly no width
  const PredictionError exact = prediction_error(c, shear(), rehearsals(c, 0, 0));
  EXPECT_EQ(exact.quantities[2].quantity, "F_par");
  EXPECT_LT(exact.quantities[0].discrepancy, 1e-5);
  // P* is nearly the same along the path, as is its largest value
  const QuantityPrecision off = prediction_error(c, shear(), rehearsals(c, 0.05, 0)).quantities[0];
  EXPECT_NEAR(off.discrepancy, 0.05, 0.01);
  EXPECT_NEAR(off.discrepancy_min, off.discrepancy, 1e-4);
  // four packings of +-.03 have a mean with e^2 = .03^2/3
  const QuantityPrecision noisy = prediction_error(c, shear(), rehearsals(c, 0.05, 0.03)).quantities[0];
  const double e2 = 0.03 * 0.03 / 3, scale = off.discrepancy / 0.05;
  EXPECT_NEAR(noisy.discrepancy / scale, std::sqrt(0.05 * 0.05 - e2), 1e-4);
  const double D2 = 0.05 * 0.05 - e2, error = std::sqrt(4 * D2 * e2 + 2 * e2 * e2);
  EXPECT_NEAR(noisy.discrepancy_min / scale, std::sqrt(std::max(0.0, D2 - 2 * error)), 1e-3);
  EXPECT_EQ(prediction_error(c, shear(), rehearsals(c, 0, 0.1)).quantities[0].discrepancy, 0);
}

TEST(PredictionError, AWideBandExplainsAsMuchAsChance) {
  const CalibratedLaw c = law_with_errors(0.002);
  const double width = prediction_error(c, shear(), {}).quantities[0].half_width;
  const double within = 0.2 * width;
  EXPECT_EQ(prediction_error(c, shear(), rehearsals(c, within, 0)).quantities[0].discrepancy, 0);
  EXPECT_GT(prediction_error(c, shear(), rehearsals(c, 2 * width, 0)).quantities[0].discrepancy_min, 0);
}

TEST(PredictionError, OneRehearsalSaysNothing) {
  const CalibratedLaw c = law_with_errors(0.002);
  auto one = rehearsals(c, 0.5, 0);
  one.resize(1);
  EXPECT_TRUE(std::isnan(prediction_error(c, shear(), one).quantities[0].discrepancy));
}

}  // namespace
}  // namespace grainlaw::chain
