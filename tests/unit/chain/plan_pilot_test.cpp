#include "chain/planning/plan_pilot.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

/// Shear to .3 in steps of .01 whose values are `value` beyond eps_dev = .215 and `early` up to it.
TestRecord shear(double nu, std::uint64_t seed, double value, double early) {
  TestRecord test;
  test.name = "D2-" + std::to_string(nu) + "-s" + std::to_string(seed);
  test.path = {nu, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.3}}};
  test.packing.seed = seed;
  for (int i = 0; i <= 30; ++i) {
    Observation row;
    row.nu = nu;
    row.shear_path = 0.01 * i;
    row.P_star = row.s_par = row.F_par = row.shear_path < 0.215 ? early : value;
    row.energy_residual = 1e-4 * i * (i % 2 ? 1 : -1);
    test.rows.push_back(row);
  }
  return test;
}

/// 2 x 2: deviations +-a of packings, +-b of tests beyond them.
std::vector<TestRecord> square(double a, double b) {
  std::vector<TestRecord> tests;
  for (const int i : {-1, 1}) {
    for (const int j : {-1, 1}) {
      const double x = 1 + a * i + b * i * j;
      tests.push_back(shear(0.75 + 0.05 * j, static_cast<std::uint64_t>(i + 5), (2 + j) * x, (2 + j) * x));
    }
  }
  return tests;
}

TEST(PlanPilot, TellsWhatPackingsShareFromWhatTestsHave) {
  // deviations of packings +-a: mean squares 2 (2 a^2) with one degree of freedom; within 4 b^2 with one
  const auto s = steady_scatter(square(0.1, 0.02), "s_par", {0.3});
  EXPECT_NEAR(s[0].within, 4 * 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(s[0].between, 2 * 0.1 * 0.1 - 4 * 0.02 * 0.02 / 2, 1e-12);
  EXPECT_EQ(steady_scatter(square(0, 0.02), "s_par", {0.3})[0].between, 0);
}

TEST(PlanPilot, SteadyMeansEndWhereTheShearWould) {
  std::vector<TestRecord> tests;
  for (const std::uint64_t seed : {1u, 2u}) {
    for (const double nu : {0.7, 0.8}) tests.push_back(shear(nu, seed, 1, 1 + 0.1 * static_cast<double>(seed)));
  }
  const auto s = steady_scatter(tests, "P_star", {0.21, 0.3});
  EXPECT_NEAR(s[0].between, 2 * std::pow(0.05 / 1.15, 2), 1e-12);
  EXPECT_LT(s[1].between, s[0].between);
  EXPECT_THROW(steady_scatter(tests, "P_star", {0.14}), Error);
  tests.resize(2);  // one packing
  EXPECT_THROW(steady_scatter(tests, "P_star", {0.3}), Error);
}

TEST(PlanPilot, DifferencesArePairedOrNot) {
  std::vector<TestRecord> fine, coarse;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const double x = 1 + 0.1 * (static_cast<double>(seed) - 2);
    fine.push_back(shear(0.7, seed, x, x));
    coarse.push_back(shear(0.7, seed, x + 0.2, x + 0.2));
  }
  const Difference paired = difference_of(coarse, fine, "F_par", true),
                   not_paired = difference_of(coarse, fine, "F_par", false);
  EXPECT_NEAR(paired.mean, 0.2, 1e-12);
  EXPECT_NEAR(paired.standard_error, 0, 1e-12);
  EXPECT_NEAR(not_paired.mean, 0.2, 1e-12);
  EXPECT_NEAR(not_paired.standard_error, 0.1 * std::sqrt(2.0 / 3), 1e-12);
}

TEST(PlanPilot, TheStepsBiasIsTheEnergyTheyMakeOrLose) {
  EXPECT_NEAR(energy_residual({shear(0.7, 1, 1, 1), shear(0.8, 1, 1, 1)}), 30e-4, 1e-15);
}

TEST(PlanPilot, SecondsAreTakenFromTheRuns) {
  Dataset dataset;
  for (const std::uint64_t seed : {1u, 2u}) {
    TestRecord test = shear(0.7, seed, 1, 1);
    test.packing.particles = 100;
    dataset.tests.push_back({test, "", "test" + std::to_string(seed), {50, 1e-8, 4}, {}});
    // two branches of one preparation
    for (int branch = 0; branch < 2; ++branch)
      dataset.tests.push_back({test, "", "preparation" + std::to_string(seed), {0, 0, 10}, {}});
    dataset.seeds.push_back(seed);
  }
  const CostRates rates = cost_rates(dataset, {6000, 5000, 200, 1}, 12, 2);
  EXPECT_DOUBLE_EQ(rates.particle_step, 4.0 / 5000 / 2);
  EXPECT_DOUBLE_EQ(rates.relaxed, (10 - 6000 * 4.0 / 5000) / 200 / 2);
  EXPECT_DOUBLE_EQ(rates.fitted_test, 6);
}

}  // namespace
}  // namespace grainlaw::chain
