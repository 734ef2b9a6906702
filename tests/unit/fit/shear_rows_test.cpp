#include "fit/data/shear_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

std::vector<double> strains(double to, int rows) {
  std::vector<double> e;
  for (int i = 0; i <= rows; ++i) e.push_back(to * i / rows);
  return e;
}

double weight_in(const RowWeights& rows, const std::vector<double>& e, double from, double to) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.row.size(); ++i) {
    if (e[rows.row[i]] >= from && e[rows.row[i]] <= to) sum += rows.weight[i] * rows.weight[i];
  }
  return sum;
}

TEST(ShearWindow, WeightOfAWindowDoesNotDependOnTheLengthOfTheTest) {
  for (const double to : {0.3, 1.0}) {
    const std::vector<double> e = strains(to, 400);
    const RowWeights rows = shear_window(e, {});  // steady_weight 3, squared in the cost
    EXPECT_NEAR(weight_in(rows, e, 0, 0.1201), 1, 1e-12) << to;
    EXPECT_NEAR(weight_in(rows, e, 0.1499, to), 9, 1e-12) << to;
    EXPECT_EQ(weight_in(rows, e, 0.1201, 0.1499), 0) << to;
  }
}

TEST(ShearWindow, StartIsNoDatumAndTheWindowsHaveTheirEnds) {
  const std::vector<double> e{0, 0.12, 0.13, 0.15};
  const RowWeights rows = shear_window(e, {});
  EXPECT_EQ(rows.row, (std::vector<std::size_t>{1, 3}));
}

TEST(ShearWindow, FewRowsDoNotWeighLikeAFullWindow) {
  const RowWeights rows = shear_window({0, 0.05, 0.2}, {});
  ASSERT_EQ(rows.weight.size(), 2u);
  EXPECT_NEAR(rows.weight[0] * rows.weight[0], 1.0 / kFullWindow, 1e-15);
}

TEST(ShearWindow, WholeWindowTakesAllButTheStart) {
  const RowWeights rows = whole_window(strains(0.05, 40));
  EXPECT_EQ(rows.row.size(), 40u);
  EXPECT_NEAR(std::inner_product(rows.weight.begin(), rows.weight.end(), rows.weight.begin(), 0.0), 1, 1e-12);
}

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

TEST(MeasuredState, DropsTheUnitOfStressOnly) {
  // k/(2<r>) = 1e8/2e-3 = 5e10 Pa. Uniaxial along z: |sigma|_dev = sigma_zz - sigma_xx, |F|_dev likewise.
  TestRecord test;
  test.packing = {1, 100, 3, 1e-3, 1e8};
  Observation row;
  row.stress.tensor = Eigen::Vector3d(1e9, 1e9, 4e9).asDiagonal();
  row.fabric.tensor = Eigen::Vector3d(1.8, 1.8, 2.1).asDiagonal();
  row.P_star = 2e9 / 5e10;
  const LawState<double> state = measured_state(test, row);
  EXPECT_DOUBLE_EQ(state.P, 0.04);
  EXPECT_NEAR(state.sigma.norm(), 3e9 / 5e10, 1e-15);
  EXPECT_NEAR(state.F.norm(), 0.3, 1e-15);
  // Compression along z leads to stress and fabric along +N.
  const LawDirection direction = law_direction(direction_of(Mode::UNI));
  EXPECT_GT(state.sigma.dot(direction.N), 0);
  EXPECT_GT(state.F.dot(direction.N), 0);
}

}  // namespace
}  // namespace grainlaw::fit
