#include "fit/data/packing_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace grainlaw::fit {
namespace {

const LawParameters<double> kLaw = published_parameters();

/// D2 at nu on a packing with P* = P + off B, s_par and F_par off by as much.
TestRecord run(std::uint64_t packing, double nu, double off, double eps_dev = 0.2) {
  constexpr std::size_t rows = 10;
  TestRecord test;
  test.packing.seed = packing;
  test.path = {nu, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, eps_dev}}};
  for (std::size_t i = 0; i < rows; ++i) {
    Observation row;
    row.nu = nu;
    row.P_star = kLaw.isotropic.P_star(nu) + off * kLaw.isotropic.B_star(nu);
    row.s_par = 0.01 * static_cast<double>(i) + 2 * off;
    row.F_par = 0.02 - 3 * off;
    test.rows.push_back(row);
  }
  return test;
}

TEST(PackingScatter, IsTheStandardDeviationBetweenRunsOfAPath) {
  const TestRecord a = run(1, 0.70, -1e-3), b = run(2, 0.70, 0), c = run(3, 0.70, 1e-3);
  const PackingScatter scatter = packing_scatter({{}, {&a, &b, &c}, {}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 3);
  EXPECT_NEAR(scatter.degrees_of_freedom, 2, 1e-9);
  EXPECT_NEAR(scatter.compression, 1e-3, 1e-12);  // sum of squares 2e-6 over G - 1 = 2
  EXPECT_NEAR(scatter.s_par, 2e-3, 1e-12);
  EXPECT_NEAR(scatter.F_par, 3e-3, 1e-12);
}

TEST(PackingScatter, AveragesTheVariancesOfPathsWhateverTheirDensity) {
  const TestRecord a = run(1, 0.70, -1e-3), b = run(2, 0.70, 1e-3), c = run(1, 0.80, -2e-3), d = run(2, 0.80, 2e-3),
                   alone = run(3, 0.74, 0.1), other = run(3, 0.70, 0.1, 0.3), again = run(2, 0.80, 0.1);
  const PackingScatter scatter = packing_scatter({{}, {&a, &c, &alone, &b}, {&other, &d, &again}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 2);
  EXPECT_EQ(scatter.degrees_of_freedom, 1) << "two of two paths, a quarter counts, one at least";
  EXPECT_NEAR(scatter.compression, std::sqrt((2e-6 + 8e-6) / 2), 1e-12);
}

TEST(PackingScatter, LeavesOutRowsBelowElsewhereAndWithoutAValue) {
  TestRecord a = run(1, 0.70, -1e-3), b = run(2, 0.70, 1e-3);
  for (TestRecord* test : {&a, &b}) test->rows[0].nu = 0.67;
  a.rows[0].P_star = 1;  // not read
  a.rows[1].s_par = Observation::undefined;
  b.rows[1].s_par = 1;
  a.rows[2].strain.tensor(0, 2) = 2e-3;
  a.rows[2].P_star = 1;
  const PackingScatter scatter = packing_scatter({{}, {&a, &b}, {}, {}}, kLaw, 0.675);
  EXPECT_NEAR(scatter.compression, std::sqrt(2e-6), 1e-12);
  EXPECT_NEAR(scatter.s_par, 2 * std::sqrt(2e-6), 1e-12);
}

// Half of kSameDensity apart at the start; were P* not taken relative to the law, they would differ by 7e-4.
TEST(PackingScatter, IsNotThatOfWherePackingsStart) {
  const TestRecord a = run(1, 0.70, -1e-3), b = run(2, 0.7005, 1e-3);
  const PackingScatter scatter = packing_scatter({{}, {&a, &b}, {}, {}}, kLaw, 0.675);
  EXPECT_NEAR(scatter.compression, std::sqrt(2e-6), 1e-12);
}

// Twelve paths, of which three each are off alike: four say something of a packing. Over sets of five packings, variances vary as those of 16
// degrees of freedom do, and the sets say so: on the average of 1/n, and not as if all 48 counted.
TEST(PackingScatter, PathsThatAreAlikeCountOnce) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal(0, 1e-3);
  constexpr int kSets = 300;
  double inverse = 0, sum = 0, squares = 0;
  for (int set = 0; set < kSets; ++set) {
    std::vector<TestRecord> runs;
    for (std::uint64_t packing = 0; packing < 5; ++packing) {
      for (int kind = 0; kind < 4; ++kind) {
        const double off = normal(generator);
        for (int i = 0; i < 3; ++i) runs.push_back(run(packing, 0.68 + 0.04 * kind + 0.01 * i, off));
      }
    }
    DataSet data;
    for (const TestRecord& test : runs) data.pure_shear.push_back(&test);
    const PackingScatter scatter = packing_scatter(data, kLaw, 0.675);
    const double variance = scatter.s_par * scatter.s_par;
    inverse += 1 / scatter.degrees_of_freedom / kSets;
    sum += variance / kSets;
    squares += variance * variance / kSets;
  }
  EXPECT_NEAR((squares - sum * sum) / (2 * sum * sum) * 16, 1, 0.25);
  EXPECT_NEAR(inverse * 16, 1, 0.25);
}

TEST(PackingScatter, OfSingleRunsIsUnknown) {
  const TestRecord a = run(1, 0.70, 0), b = run(2, 0.72, 0);
  const PackingScatter scatter = packing_scatter({{}, {&a, &b}, {}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 1);
  EXPECT_EQ(scatter.degrees_of_freedom, 0);
  EXPECT_TRUE(std::isnan(scatter.compression) && std::isnan(scatter.s_par) && std::isnan(scatter.F_par));
}

}  // namespace
}  // namespace grainlaw::fit
