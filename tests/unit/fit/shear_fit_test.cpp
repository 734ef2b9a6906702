#include "fit/stages/shear_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

/// D2 on which s and F are exactly Eqs. (17) and (18) from s_0 and F_0, P constant.
TestRecord exact_shear(double nu, double s_max, double beta_s, double F_max, double beta_F, double strain,
                       double s_0 = 0.01, double F_0 = -0.005) {
  TestRecord test;
  test.name = "d2";
  test.path = {nu, Branch::unloading, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, strain)}};
  test.packing = {7, 1000, 3, 1e-3, 1e8};
  const StraightSegment segment = resolve(test.path).front();
  const Deviator<double> N = law_direction(segment.direction).N;
  for (int i = 0; i <= 100; ++i) {
    Observation row;
    const double e = segment.length * i / 100, g = segment.eps_dev_rate() * e, P = 0.02;
    row.strain = segment.strain(e);
    row.nu = nu;
    row.P_star = P;
    row.stress.tensor =
        test.packing.stress_unit() * P *
        (tensor_of<double>(N * (s_max - (s_max - s_0) * std::exp(-beta_s * g))) + Eigen::Matrix3d::Identity());
    row.fabric.tensor =
        tensor_of<double>(N * (F_max - (F_max - F_0) * std::exp(-beta_F * g))) + 2 * Eigen::Matrix3d::Identity();
    row.C_star = 8;
    row.rattler_fraction = 0.05;
    test.rows.push_back(row);
  }
  return test;
}

TEST(ShearFit, RecoversEqs17And18WithTheirMeasuredStart) {
  Stage stage;
  const ShearFit fit = fit_shear(exact_shear(0.70, 0.1744, 54.4, 0.1335, 43.8, 0.3), 0.6649, {}, {}, stage);
  EXPECT_EQ(fit.s_max.status, Status::fitted);
  EXPECT_NEAR(fit.s_max.value, 0.1744, 1e-10);
  EXPECT_NEAR(fit.beta_s.value, 54.4, 1e-7);
  EXPECT_NEAR(fit.F_max.value, 0.1335, 1e-10);
  EXPECT_NEAR(fit.beta_F.value, 43.8, 1e-7);
  EXPECT_NEAR(fit.s_0, 0.01, 1e-12);
  EXPECT_NEAR(fit.F_0, -0.005, 1e-12);
  EXPECT_NEAR(fit.eps_dev_max, 0.3, 1e-12);
  EXPECT_EQ(fit.seed, 7u);
  EXPECT_TRUE(std::isnan(fit.s_max.standard_error));
  EXPECT_NEAR(fit.P_star, 0.02, 1e-15);
  EXPECT_NEAR(fit.C_star, 8, 1e-14);
  // Mean of s from .15 on is within s_max e^(-54.4*.15) of the limit.
  EXPECT_NEAR(fit.s_steady, 0.1744, 0.17 * std::exp(-54.4 * 0.15));
  EXPECT_EQ(stage.tests.size(), 2u);
}

TEST(ShearFit, ARateFasterThanItsRowsIsNone) {
  Stage stage;
  const ShearFit fit = fit_shear(exact_shear(0.70, 0.1744, 1e6, 0.1335, 43.8, 0.3), 0.6649, {}, {}, stage);
  EXPECT_EQ(fit.beta_s.status, Status::not_identified);
  EXPECT_NE(fit.beta_s.note.find("closer together"), std::string::npos) << fit.beta_s.note;
  EXPECT_NEAR(fit.s_max.value, 0.1744, 1e-3);
  EXPECT_EQ(fit.s_max.status, Status::fitted);
  EXPECT_EQ(fit.beta_F.status, Status::fitted);
}

TEST(ShearFit, TakesComponentsAlongTheShear) {
  TestRecord test = exact_shear(0.70, 0.1744, 54.4, 0.1335, 43.8, 0.3, -0.01);
  for (Observation& row : test.rows) {
    Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
    across(0, 1) = across(1, 0) = 0.1;
    row.stress.tensor += row.P_star * test.packing.stress_unit() * across;
    row.fabric.tensor += across;
  }
  Stage stage;
  const ShearFit fit = fit_shear(test, 0.6649, {}, {}, stage);
  EXPECT_NEAR(fit.s_max.value, 0.1744, 1e-10);
  EXPECT_NEAR(fit.F_max.value, 0.1335, 1e-10);
  EXPECT_NEAR(fit.s_0, -0.01, 1e-12);
}

TEST(ShearFit, ALineFromItsStartShowsNoSaturation) {
  const double start = 0.2, misfit = 1e-12, rate = 5;
  std::vector<double> eps_dev, line, curve;
  for (int i = 1; i <= 30; ++i) {
    eps_dev.push_back(0.01 * i);
    line.push_back(start + 0.5 * eps_dev.back());
    curve.push_back(start + 0.5 * (1 - std::exp(-rate * eps_dev.back())));
  }
  const std::vector<double> weight(eps_dev.size(), 1.0);
  EXPECT_FALSE(shows_saturation(eps_dev, line, weight, start, rate, misfit));
  EXPECT_TRUE(shows_saturation(eps_dev, curve, weight, start, rate, misfit));
  EXPECT_FALSE(shows_saturation(eps_dev, curve, weight, start, 0.49 / eps_dev.back(), misfit)) << "too short";
}

TEST(ShearFit, LimitIsTheSteadyMeanWhereThereIsAPeak) {
  // Overshoot of 10 % up to eps_dev = .13, steady afterwards.
  TestRecord test = exact_shear(0.70, 0.17, 50, 0.13, 40, 0.3, 0, 0);
  for (Observation& row : test.rows) {
    if (deviatoric_norm(row.strain.tensor) > 0.13) continue;
    row.stress.tensor = 1.1 * row.stress.tensor - 0.1 * row.stress.tensor.trace() / 3 * Eigen::Matrix3d::Identity();
  }
  Stage stage;
  const ShearFit fit = fit_shear(test, 0.6649, {}, {}, stage);
  EXPECT_NEAR(fit.s_max.value, fit.s_steady, 0.01 * fit.s_steady);
  EXPECT_GT(fit.beta_s.value, 50);  // the peak is taken for a faster rise
}

TEST(ShearFit, AShortPathShowsASlopeOnly) {
  Stage stage;
  const double beta = 20;
  const ShearFit fit = fit_shear(exact_shear(0.80, 0.13, beta, 0.06, beta, 0.4 / beta), 0.6649, {}, {}, stage);
  for (const Estimate& e : {fit.s_max, fit.beta_s, fit.F_max, fit.beta_F}) {
    EXPECT_EQ(e.status, Status::not_identified);
    EXPECT_NE(e.note.find("saturation"), std::string::npos) << e.note;
  }
  EXPECT_TRUE(std::isnan(fit.s_steady));
}

TEST(ShearFit, ARateThatActsOnNothingIsNoRate) {
  Stage stage;
  const ShearFit fit = fit_shear(exact_shear(0.80, 0.13, 30, 1e-6, 20, 0.3, 0, 0), 0.6649, {}, {}, stage);
  EXPECT_EQ(fit.s_max.status, Status::fitted);
  EXPECT_EQ(fit.beta_s.status, Status::fitted);
  EXPECT_EQ(fit.F_max.status, Status::fitted) << fit.F_max.note;
  EXPECT_NEAR(fit.F_max.value, 1e-6, 1e-8);
  EXPECT_EQ(fit.beta_F.status, Status::not_identified);
}

TEST(ShearFit, TestsThatAreNotJammedLeaveAndAreCounted) {
  Stage stage;
  const ShearFit fit = fit_shear(exact_shear(0.66, 0.2, 50, 0.15, 50, 0.3), 0.6649, {}, {}, stage);
  EXPECT_EQ(fit.s_max.status, Status::not_identified);
  ASSERT_EQ(stage.tests.size(), 2u);
  EXPECT_EQ(stage.tests[0].rows, 0);
  EXPECT_EQ(stage.tests[0].rows_excluded, 101);
}

TEST(ShearFit, ReversedShearGivesTheSamePositiveNumbers) {
  TestRecord test = exact_shear(0.70, 0.17, 50, 0.13, 40, 0.3, 0, 0);
  test.path.segments[0].direction = direction_of(Mode::D2, "xyz", true);
  const Deviator<double> N = law_direction(test.path.segments[0].direction).N;
  for (Observation& row : test.rows) {
    row.strain.tensor *= -1;
    row.stress.tensor = -row.stress.tensor + 2 * row.stress.tensor.trace() / 3 * Eigen::Matrix3d::Identity();
    row.fabric.tensor = -row.fabric.tensor + 2 * row.fabric.tensor.trace() / 3 * Eigen::Matrix3d::Identity();
  }
  ASSERT_GT(deviator<double>(test.rows.back().stress.tensor).dot(N), 0);
  Stage stage;
  const ShearFit fit = fit_shear(test, 0.6649, {}, {}, stage);
  EXPECT_NEAR(fit.s_max.value, 0.17, 1e-9);
  EXPECT_NEAR(fit.F_max.value, 0.13, 1e-9);
}

}  // namespace
}  // namespace grainlaw::fit
