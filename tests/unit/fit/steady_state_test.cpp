#include "fit/stages/steady_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

// x = 0 for the first m of n rows, 1 afterwards: with d rows left out the criterion is (m-d)(n-m)/(n-d)^3, least at d = m.
TEST(SteadyState, AStepIsLeftOutAsAWhole) {
  for (const int m : {1, 10, 49}) {
    std::vector<double> x(100, 1);
    std::fill_n(x.begin(), m, 0);
    EXPECT_EQ(steady_row(x), m);
  }
  std::vector<double> late(100, 1);
  std::fill_n(late.begin(), 50, 0);  // the search ends with the first row of the plateau
  EXPECT_EQ(steady_row(late), -1);
}

TEST(SteadyState, AConstantIsSteadyFromTheStartAndASlopeNever) {
  std::vector<double> constant(50, 0.2), slope;
  for (int i = 0; i < 50; ++i) slope.push_back(0.01 * i);
  EXPECT_EQ(steady_row(constant), 0);
  EXPECT_EQ(steady_row(slope), -1);
  EXPECT_EQ(steady_row({1, 1, 1, 1, 1, 1, 1}), -1) << "too few rows to tell";
}

// 1 - exp(-k i) with white noise of size a: the transient is below the noise when k i > ln(1/a).
TEST(SteadyState, ATransientEndsWhereTheNoiseHidesIt) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  const double a = 0.05, k = 0.1;
  std::vector<double> x;
  for (int i = 0; i < 400; ++i) x.push_back(1 - std::exp(-k * i) + a * normal(engine));
  const int row = steady_row(x);
  EXPECT_GT(k * row, 0.3 * std::log(1 / a));
  EXPECT_LT(k * row, 2 * std::log(1 / a));
}

TEST(SteadyState, OnsetsOfATestAreStrains) {
  testing::SyntheticOptions options;
  options.densities = {0.70};
  options.seeds = {1};
  options.rows = 100;
  options.sequences = false;
  options.shear_strain = 0.5;
  options.noise_s = options.noise_F = 0.003;
  const std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  const SteadyOnset onset = steady_onset(tests[1]);
  // beta_s = 54, beta_F = 44 at .70: within noise of the limit after ln(s_max/noise)/beta = .07 and .09.
  EXPECT_GT(onset.s, 0.03);
  EXPECT_LT(onset.s, 0.15);
  EXPECT_GT(onset.F, 0.03);
  EXPECT_LT(onset.F, 0.15);
  EXPECT_EQ(onset.from(0.2), 0.2);
  EXPECT_EQ(SteadyOnset({0.1, 0.3, std::nan("")}).from(0.15), 0.3);
}

}  // namespace
}  // namespace grainlaw::fit
