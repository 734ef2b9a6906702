#include "predict/bands.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/student.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;

using testing::kInfinity;

/// D2 at nu = 0.74 by the reduced law, with bands.
Prediction banded(const CalibratedLaw& law) {
  const auto path = testing::path_from(0.74, {leg(Mode::D2, 0.2)});
  return predict_with_bands(Rung::reduced, law, path, state_from_law(law.parameters, 0.74), true,
                            uniform_points(path, 4), {});
}

/// The published law with errors of the parameters `names`.
CalibratedLaw with_errors(const std::vector<const char*>& names, const Eigen::MatrixXd& covariance,
                          double degrees_of_freedom) {
  CalibratedLaw law;
  law.parameters = published_parameters();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  std::vector<std::size_t> indices;
  for (const char* name : names) {
    indices.push_back(parameter_index(name));
    law.estimates[indices.back()].degrees_of_freedom = degrees_of_freedom;
  }
  law.covariance(indices, indices) = covariance;
  return law;
}

TEST(Bands, OfPFollowItsPrefactor) {
  // P* is proportional to p0: its relative half width is p0's
  const double p0 = published_parameters().isotropic.pressure.p0, error = 0.01 * p0;
  const Prediction prediction = banded(with_errors({"pressure.p0"}, Eigen::MatrixXd::Constant(1, 1, error * error), 2));
  for (const PredictedRow& row : prediction.rows) {
    EXPECT_NEAR(row.mean.P, student_95(2) * 0.01 * row.state.P, 1e-8 * row.state.P);
    EXPECT_NEAR(row.mean.s_par, 0, 1e-10) << "the ratio does not move";
    EXPECT_TRUE(std::isnan(row.single.P)) << "without scatter between packings";
  }
}

TEST(Bands, CountCorrelationsAndTheSignsOfSlopes) {
  // two prefactors of s_max, Q_limit + Q_c decay: errors that cancel at the decay of this density leave no band
  const LawParameters<double> p = published_parameters();
  const double decay = std::exp(-p.stress_ratio_max.alpha * (0.74 / p.shear_nu_c - 1));
  const Eigen::Vector2d direction(decay, -1);
  const Prediction cancelled = banded(with_errors({"stress_ratio_max.Q_limit", "stress_ratio_max.Q_c"},
                                                  1e-4 * direction * direction.transpose(), kInfinity));
  EXPECT_NEAR(cancelled.rows.back().mean.s_par, 0, 1e-7);
  const Prediction independent = banded(with_errors({"stress_ratio_max.Q_limit", "stress_ratio_max.Q_c"},
                                                    1e-4 * Eigen::MatrixXd::Identity(2, 2), kInfinity));
  const double grown = 1 - std::exp(-p.stress_rate.value(0.74, p.shear_nu_c) * 0.2);
  EXPECT_NEAR(independent.rows.back().mean.s_par, student_95(kInfinity) * 1e-2 * grown * std::hypot(1, decay), 1e-8);
}

TEST(Bands, OfASingleRunAddTheScatter) {
  const double p0 = published_parameters().isotropic.pressure.p0, error = 0.01 * p0;
  CalibratedLaw law = with_errors({"pressure.p0"}, Eigen::MatrixXd::Constant(1, 1, error * error), 2);
  law.scatter = {3, 22, 1e-3, 0.02, 0.01};
  const LawParameters<double> p = published_parameters();
  for (const PredictedRow& row : banded(law).rows) {
    const double mean = student_95(2) * 0.01 * row.state.P, scatter = student_95(22) * 1e-3 * p.isotropic.B_star(0.74);
    EXPECT_NEAR(row.single.P, std::hypot(mean, scatter), 1e-8 * row.state.P);
    EXPECT_NEAR(row.single.s_par, student_95(22) * 0.02, 1e-8) << "where the mean is known";
    EXPECT_NEAR(row.single.F_dev, student_95(22) * 0.01, 1e-8);
  }
}

TEST(Bands, DegreesOfFreedomAreThoseOfWhatMovesTheCurve) {
  CalibratedLaw law =
      with_errors({"pressure.p0", "stress_ratio_max.Q_limit"}, 1e-6 * Eigen::MatrixXd::Identity(2, 2), 2);
  law.estimates[parameter_index("stress_ratio_max.Q_limit")].degrees_of_freedom = 20;
  const PredictedRow end = banded(law).rows.back();
  const LawParameters<double> p = published_parameters();
  EXPECT_NEAR(end.mean.P, student_95(2) * 1e-3 * end.state.P / p.isotropic.pressure.p0, 1e-6 * end.state.P);
  const double grown = 1 - std::exp(-p.stress_rate.value(0.74, p.shear_nu_c) * 0.2);
  EXPECT_NEAR(end.mean.s_par, student_95(20) * 1e-3 * grown, 1e-8);
}

TEST(Bands, AMeasuredStartHasNoError) {
  const CalibratedLaw law = with_errors({"pressure.p0"}, Eigen::MatrixXd::Constant(1, 1, 1e-8), 2);
  // the closed form reads no P from its start, but evolution does: at constant volume P stays where it began
  const auto path = testing::path_from(0.74, {leg(Mode::D2, 0.2)});
  for (const bool from_law : {true, false}) {
    const Prediction prediction =
        predict_with_bands(Rung::evolution, law, path, state_from_law(law.parameters, 0.74), from_law, {{0, 0.0}}, {});
    EXPECT_EQ(prediction.rows[0].mean.P > 0, from_law);
  }
}

TEST(Bands, RehearsalsAddTheLawsOwnError) {
  const double p0 = published_parameters().isotropic.pressure.p0, error = 0.01 * p0;
  CalibratedLaw law = with_errors({"pressure.p0"}, Eigen::MatrixXd::Constant(1, 1, error * error), 2);
  law.scatter = {3, 22, 1e-3, 0.02, 0.01};
  for (const double nu : {0.70, 0.71}) {
    Rehearsal& r = law.rehearsals.emplace_back();
    r.path = {nu, Branch::unloading, {leg(Mode::D2, 0.2)}};
    r.rungs = {{Rung::reduced, {90, 1e-6, 0, 2e-3}, {90, 0.0049, 0, 0.1}, {90, 0.01, 0, 0.2}}};
  }
  const ErrorUnits w = error_units(law.parameters, 0.74);
  for (const PredictedRow& row : banded(law).rows) {
    // P: g.V g with 2 degrees of freedom, w^2 tau^2 with as many as there are paths, 2 as well
    const double variance = std::pow(0.01 * row.state.P, 2) + std::pow(1e-3 * w.B, 2);
    EXPECT_NEAR(row.mean.P, student_95(2) * std::sqrt(variance), 1e-7 * row.state.P);
    EXPECT_NEAR(row.mean.s_par, student_95(2) * 0.07 * w.s_max, 1e-9);
    EXPECT_NEAR(row.mean.F_dev, student_95(2) * 0.1 * w.F_max, 1e-9);
    EXPECT_NEAR(row.single.F_par, std::hypot(student_95(2) * 0.1 * w.F_max, student_95(22) * 0.01), 1e-9);
  }
}

TEST(Bands, WithTheLawsOwnErrorHoldWhatTheyPromise) {
  // paths off by normal numbers of variance tau^2 + known, tau = 1: the band made of m of them holds another one in 95 %
  std::mt19937_64 engine(5);
  for (const int m : {3, 4, 8, 16}) {
    for (const double known : {0.0, 0.25, 1.0, 4.0}) {
      std::normal_distribution<double> off(0, std::sqrt(1 + known));
      std::vector<Rehearsal> paths(static_cast<std::size_t>(m));
      for (Rehearsal& path : paths) path.rungs = {{Rung::memory, {}, {}, {}}};
      Spokesmen spokesmen;
      for (const Rehearsal& path : paths) spokesmen.rehearsals.push_back(&path);
      constexpr int kPaths = 20000;
      int within = 0;
      for (int i = 0; i < kPaths; ++i) {
        for (Rehearsal& path : paths) path.rungs[0].s_par = {100, std::pow(off(engine), 2), known, 0};
        const LawError error = law_error(spokesmen, Rung::memory, Rehearsed::s_par);
        const Variance variance = widened({known}, error.tau * error.tau, error.degrees_of_freedom);
        within += std::abs(off(engine)) <= student_95(variance.degrees_of_freedom) * std::sqrt(variance.value);
      }
      const double share = static_cast<double>(within) / kPaths;
      EXPECT_GE(share, 0.93) << m << " paths, known " << known;
      EXPECT_LE(share, 0.97) << m << " paths, known " << known;
    }
  }
}

TEST(Bands, TheLawsOwnErrorHasNoMoreDegreesOfFreedomThanPaths) {
  EXPECT_EQ(widened({1, 50}, 3, 4).degrees_of_freedom, 4);
  EXPECT_DOUBLE_EQ(widened({3, 2}, 1, 40).degrees_of_freedom, 4 / (3.0 / 2 + 1.0 / 40))
      << "parameters may be known worse";
  EXPECT_EQ(widened({3, 2}, 0, 40).degrees_of_freedom, 2) << "no error of its own was seen";
  EXPECT_EQ(widened({3, 2}, std::nan(""), 0).value, 3) << "nothing was rehearsed";
}

TEST(Bands, DegreesOfFreedomAreWeightedByShares) {
  const Variance sum = sum_of({3, 2}, {1, 4});
  EXPECT_DOUBLE_EQ(sum.value, 4);
  EXPECT_DOUBLE_EQ(sum.degrees_of_freedom, 4 / (3.0 / 2 + 1.0 / 4));
  EXPECT_EQ(sum_of({3, 2}, {0, 1}).degrees_of_freedom, 2) << "what is nothing does not count";
  EXPECT_EQ(sum_of({0, 2}, {3, 1}).degrees_of_freedom, 1);
  EXPECT_TRUE(std::isnan(sum_of({std::nan(""), 2}, {3, 1}).value));
}

TEST(Bands, AreNoneWithoutErrors) {
  for (const PredictedRow& row : banded(with_errors({}, Eigen::MatrixXd(0, 0), 2)).rows) {
    EXPECT_TRUE(std::isnan(row.mean.P));
    EXPECT_TRUE(std::isnan(row.single.F_par));
  }
}

TEST(Bands, AMemoryThatUnjamsKeepsItsCurveAndTheBandsBeforeThat) {
  const CalibratedLaw law = with_errors({"pressure.nu_c"}, Eigen::MatrixXd::Constant(1, 1, 1e-8), 4);
  for (const double nu : {0.67, 0.675, 0.68, 0.69}) {
    const auto path = testing::path_from(nu, {testing::leg_to(Mode::UNI, 0.65, true)});
    const Prediction prediction = predict_with_bands(Rung::memory, law, path, state_from_law(law.parameters, nu), true,
                                                     uniform_points(path, 40), {});
    EXPECT_TRUE(prediction.unjammed);
    EXPECT_GT(prediction.rows[5].mean.P, 0) << nu;
    EXPECT_EQ(prediction.rows.size(), 41u);
    EXPECT_TRUE(std::isnan(prediction.rows.back().mean.P)) << "where it has none";
  }
}

}  // namespace
}  // namespace grainlaw::predict
