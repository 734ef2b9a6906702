#include "app/prediction_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/staged_laws.hpp"

namespace grainlaw::app {
namespace {

/// The published law with errors of `error` times the value of each parameter.
fit::Calibration calibrated(double error) {
  fit::Calibration c = fit::nothing_known();
  c.parameters = published_parameters();
  c.parameters.anisotropy.a2 = 1.18;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (name.starts_with("memory") || name == "anisotropy.a0") continue;
    const double value = *fields(c.parameters)[i], se = error * std::abs(value);
    c.estimates[i] = {value, se, fit::Status::fitted, ""};
    c.estimates[i].degrees_of_freedom = 3;
    c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = se * se;
  }
  return c;
}

/// Residuals of a quantity on two paths and four packings: `bias` on the first, none on the second, -+ `scatter`.
void add_residuals(fit::Calibration& c, const char* quantity, double bias, double scatter) {
  if (c.stages.empty()) c.stages.emplace_back().name = "evolution";
  for (int s = 1; s <= 4; ++s) {
    const double off = s % 2 ? scatter : -scatter;
    c.stages[0].tests.push_back(
        {"D2-0.70-s" + std::to_string(s), quantity, true, 100, 0, 0, 0.1, 0.2 * (bias + off), 0.2});
    c.stages[0].tests.push_back({"D2-0.78-s" + std::to_string(s), quantity, true, 100, 0, 0, 0.1, 0.2 * off, 0.2});
  }
}

Path shear() { return {0.72, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}}; }

TEST(PredictionError, IsTheBandsHalfWidth) {
  const PredictionError one = prediction_error(calibrated(0.002), shear()),
                        two = prediction_error(calibrated(0.004), shear());
  EXPECT_EQ(one.rung, Rung::evolution);
  ASSERT_EQ(one.quantities.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(one.quantities[i].half_width, 0);
    EXPECT_LT(one.quantities[i].half_width, one.quantities[i].largest);
    EXPECT_NEAR(two.quantities[i].half_width, 2 * one.quantities[i].half_width, 1e-9);
    EXPECT_TRUE(std::isnan(one.quantities[i].discrepancy));  // no residuals
  }
  EXPECT_TRUE(std::isnan(prediction_error(calibrated(0), shear()).quantities[0].half_width));
}

TEST(PredictionError, APathWithoutShearHasPressureAlone) {
  const Path iso{0.72, Branch::unloading, {{Mode::ISO, direction_of(Mode::ISO), ExtentKind::target_nu, 0.8}}};
  const PredictionError e = prediction_error(calibrated(0.002), iso);
  ASSERT_EQ(e.quantities.size(), 1u);
  EXPECT_EQ(e.quantities[0].quantity, "P_star");
}

TEST(PredictionError, NothingIsKnownByALawThatCannotPredict) {
  fit::Calibration c = calibrated(0.002);
  c.estimates[parameter_index("anisotropy.a2")].status = fit::Status::not_identified;
  EXPECT_EQ(prediction_error(c, shear()).rung, Rung::reduced);
  c.estimates[parameter_index("fabric_rate.Q_c")].status = fit::Status::not_identified;
  const PredictionError e = prediction_error(c, shear());
  ASSERT_EQ(e.quantities.size(), 3u);
  EXPECT_TRUE(std::isnan(e.quantities[0].half_width));
}

TEST(PredictionError, DiscrepancyIsWhatScatterDoesNotExplain) {
  fit::Calibration c = calibrated(0.002);
  add_residuals(c, "P_star", 0.05, 0);
  add_residuals(c, "s_par", 0.05, 0.03);
  add_residuals(c, "F_par", 0, 0.1);
  const PredictionError e = prediction_error(c, shear());
  EXPECT_NEAR(e.quantities[0].discrepancy, 0.05 / std::sqrt(2), 1e-12);  // one of two paths
  EXPECT_NEAR(e.quantities[0].discrepancy_min, 0.05 / std::sqrt(2), 1e-12);
  // four packings of +-.03 have a mean with e^2 = .03^2/3
  EXPECT_NEAR(e.quantities[1].discrepancy, std::sqrt(0.05 * 0.05 / 2 - 0.03 * 0.03 / 3), 1e-12);
  EXPECT_LT(e.quantities[1].discrepancy_min, e.quantities[1].discrepancy);
  EXPECT_EQ(e.quantities[2].discrepancy, 0);
}

}  // namespace
}  // namespace grainlaw::app
