#include "fit/statistics/variance_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

const std::size_t kC1 = parameter_index("coordination.C1"), kAlpha = parameter_index("coordination.alpha"),
                  kNu = parameter_index("coordination.nu_c"), kD = parameter_index("overlap.D");
constexpr auto kAll = static_cast<Eigen::Index>(kParameterCount);

/// A law that knows these parameters with these standard errors, uncorrelated.
CalibratedLaw law_with(const std::vector<std::pair<std::size_t, double>>& errors, double degrees_of_freedom) {
  CalibratedLaw law;
  law.covariance = Eigen::MatrixXd::Zero(kAll, kAll);
  for (const auto& [i, error] : errors) {
    law.estimates[i] = {1, error, Status::fitted, "", degrees_of_freedom};
    law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = error * error;
  }
  return law;
}

/// Of packings of 1000 spheres.
VariancePrior prior_with(const std::vector<std::pair<std::size_t, double>>& errors, int packings, double d0) {
  VariancePrior prior{{packings, 1000. * packings}, law_with(errors, d0).covariance, Eigen::VectorXd(kAll)};
  prior.degrees_of_freedom.setConstant(std::nan(""));
  for (const auto& [i, error] : errors) prior.degrees_of_freedom(static_cast<Eigen::Index>(i)) = d0;
  return prior;
}

TEST(Moderate, WeighsVariancesByDegreesOfFreedomAndCarriesThePriorByTheSpheres) {
  CalibratedLaw law = law_with({{kD, 0.3}}, 1);
  // 40 packings know it to .05: two of the same size to .05 sqrt(20), two of four times the size to half of that
  const VariancePrior prior = prior_with({{kD, 0.05}}, 40, 3);
  const Moderation done = moderate(prior, {2, 8000}, law);
  EXPECT_EQ(done.parameters, 1);
  const double expected = (3 * 0.05 * 0.05 * 20 / 4 + 1 * 0.3 * 0.3) / 4;
  EXPECT_NEAR(law.estimates[kD].standard_error, std::sqrt(expected), 1e-15);
  EXPECT_DOUBLE_EQ(law.estimates[kD].degrees_of_freedom, 4);
  EXPECT_NEAR(law.covariance(static_cast<Eigen::Index>(kD), static_cast<Eigen::Index>(kD)), expected, 1e-15);
}

TEST(Moderate, MendsTheCorrelationThatTwoPackingsCannotKnow) {
  const auto c = static_cast<Eigen::Index>(kC1), a = static_cast<Eigen::Index>(kAlpha),
             n = static_cast<Eigen::Index>(kNu);
  VariancePrior prior = prior_with({{kC1, 1}, {kAlpha, 1}, {kNu, 1}}, 2, 9);
  CalibratedLaw law = law_with({{kC1, 1}, {kAlpha, 1}, {kNu, 1}}, 1);
  law.covariance(c, a) = law.covariance(a, c) = -1;  // of two packings every correlation is one
  law.covariance(c, n) = law.covariance(n, c) = 1;
  law.covariance(a, n) = law.covariance(n, a) = -1;
  moderate(prior, {2, 2000}, law);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kAll);
  sum(c) = sum(a) = 1;
  EXPECT_NEAR(sum.dot(law.covariance * sum), 0.9 * 2 + 0.1 * 0, 1e-14);
}

TEST(Moderate, LeavesAloneWhatThePriorDoesNotKnow) {
  const VariancePrior prior = prior_with({{kC1, 1}, {kD, 1}}, 2, 9);
  CalibratedLaw law = law_with({{kC1, 0.5}, {kAlpha, 0.5}, {kD, 0.5}}, 1);
  EXPECT_EQ(moderate(prior, {2, 2000}, law).parameters, 1) << "alpha was held where the prior was found: another fit";
  EXPECT_DOUBLE_EQ(law.estimates[kC1].standard_error, 0.5);
  EXPECT_DOUBLE_EQ(law.estimates[kAlpha].degrees_of_freedom, 1);
  EXPECT_DOUBLE_EQ(law.estimates[kD].degrees_of_freedom, 10);
}

TEST(Moderate, IsNotUsedForAnotherMaterial) {
  const VariancePrior prior = prior_with({{kC1, 1}, {kAlpha, 1}, {kNu, 1}, {kD, 1}}, 10, 20);
  for (const double factor : {0.02, 50.}) {
    CalibratedLaw law = law_with({{kC1, factor}, {kAlpha, factor}, {kNu, factor}, {kD, factor}}, 9);
    const Moderation done = moderate(prior, {10, 10000}, law);
    EXPECT_EQ(done.parameters, 0);
    EXPECT_GT(std::abs(std::log(done.ratio)), std::log(done.largest_ratio));
    EXPECT_DOUBLE_EQ(law.estimates[kC1].standard_error, factor);
    EXPECT_DOUBLE_EQ(law.estimates[kC1].degrees_of_freedom, 9);
  }
}

/// Calibrations of `packings` packings whose own variances are (sigma^2/packings) F(d, true_d0).
std::vector<SizedLaw> parts_of(int packings, double sigma, double true_d0, int count) {
  std::mt19937_64 engine(17);
  std::chi_squared_distribution<double> ours(packings - 1), others(std::isfinite(true_d0) ? true_d0 : 1);
  std::vector<SizedLaw> parts;
  for (int k = 0; k < count; ++k) {
    const double spread = std::isfinite(true_d0) ? true_d0 / others(engine) : 1;
    const double variance = sigma * sigma / packings * ours(engine) / (packings - 1) * spread;
    parts.push_back({law_with({{kD, std::sqrt(variance)}}, packings - 1), {packings, 1000. * packings}});
  }
  return parts;
}

TEST(VariancePriorOf, FindsTheDegreesOfFreedomThatVariancesScatterWith) {
  const SizedLaw many{law_with({{kD, 0.1}}, 63), {64, 64000}};
  const auto d0_of = [&](const std::vector<SizedLaw>& parts) {
    return variance_prior(many, parts).degrees_of_freedom(static_cast<Eigen::Index>(kD));
  };
  EXPECT_GT(d0_of(parts_of(5, 0.8, INFINITY, 4000)), 40) << "as chi^2 of the prior's variance: known as well as it is";
  EXPECT_NEAR(d0_of(parts_of(5, 0.8, 6, 4000)), 5.5, 1.5);
  EXPECT_LT(d0_of(parts_of(5, 8, INFINITY, 4000)), 1) << "a hundred times the variance: not the prior's kind";
  EXPECT_TRUE(std::isnan(d0_of(parts_of(5, 0.8, 6, 7)))) << "too few to tell";
}

// What moderation is for: intervals of two packings hold what they promise and are an eighth as wide.
TEST(Moderate, IntervalsOfTwoPackingsHoldTheTruth) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const VariancePrior prior = prior_with({{kD, std::sqrt(1. / 64)}}, 64, 63);
  int inside = 0;
  double width = 0;
  constexpr int kSets = 20000;
  for (int k = 0; k < kSets; ++k) {
    const double a = normal(engine), b = normal(engine);
    CalibratedLaw law = law_with({{kD, std::abs(a - b) / 2}}, 1);
    moderate(prior, {2, 2000}, law);
    inside += std::abs((a + b) / 2) <= law.estimates[kD].half_width();
    width += law.estimates[kD].half_width() / kSets;
  }
  EXPECT_NEAR(inside, 0.95 * kSets, 4 * std::sqrt(0.95 * 0.05 * kSets));
  EXPECT_LT(width, 1.5) << "without moderation " << student_95(1) * std::sqrt(1 / std::acos(-1.));
}

TEST(Moderate, AParameterThatFewOfThePackingsTellIsCarriedToThese) {
  CalibratedLaw law = law_with({{kD, 0.3}, {kC1, 0.1}, {kAlpha, 0.1}, {kNu, 0.1}}, 4);
  law.estimates[kD].degrees_of_freedom = 1;  // two of the five
  const VariancePrior prior = prior_with({{kD, 0.1}, {kC1, 0.1}, {kAlpha, 0.1}, {kNu, 0.1}}, 10, 9);
  moderate(prior, {5, 5000}, law);
  EXPECT_NEAR(std::pow(law.estimates[kD].standard_error, 2), (9 * 0.01 * 10 / 2 + 1 * 0.09) / 10, 1e-14);
  EXPECT_NEAR(std::pow(law.estimates[kC1].standard_error, 2), (9 * 0.01 * 10 / 5 + 4 * 0.01) / 13, 1e-14);
}

}  // namespace
}  // namespace grainlaw::fit
