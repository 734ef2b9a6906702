#include "fit/data/packing_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::fit {
namespace {

const LawParameters<double> kLaw = published_parameters();

/// D2 at nu with P* = P + off B, s_par and F_par off by as much, ten rows.
TestRecord run(double nu, double off, std::size_t rows = 10) {
  TestRecord test;
  test.path = {nu, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}};
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
  const TestRecord a = run(0.70, -1e-3), b = run(0.70, 0), c = run(0.70, 1e-3);
  const PackingScatter scatter = packing_scatter({{}, {&a, &b, &c}, {}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 3);
  EXPECT_EQ(scatter.degrees_of_freedom, 2);
  EXPECT_NEAR(scatter.compression, 1e-3, 1e-12);  // sum of squares 2e-6 over G - 1 = 2
  EXPECT_NEAR(scatter.s_par, 2e-3, 1e-12);
  EXPECT_NEAR(scatter.F_par, 3e-3, 1e-12);
}

TEST(PackingScatter, AveragesTheVariancesOfPathsWhateverTheirDensity) {
  const TestRecord a = run(0.70, -1e-3), b = run(0.70, 1e-3), c = run(0.80, -2e-3), d = run(0.80, 2e-3),
                   alone = run(0.74, 0.1), shorter = run(0.70, 0.1, 5);
  const PackingScatter scatter = packing_scatter({{}, {&a, &c, &alone, &b}, {&shorter, &d}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 2);
  EXPECT_EQ(scatter.degrees_of_freedom, 2) << "one each of two paths; what was run once or otherwise says nothing";
  EXPECT_NEAR(scatter.compression, std::sqrt((2e-6 + 8e-6) / 2), 1e-12);
}

TEST(PackingScatter, LeavesOutRowsBelowAndWithoutAValue) {
  TestRecord a = run(0.70, -1e-3), b = run(0.70, 1e-3);
  for (TestRecord* test : {&a, &b}) test->rows[0].nu = 0.67;
  a.rows[0].P_star = 1;  // not read
  a.rows[1].s_par = Observation::undefined;
  b.rows[1].s_par = 1;
  const PackingScatter scatter = packing_scatter({{}, {&a, &b}, {}, {}}, kLaw, 0.675);
  EXPECT_NEAR(scatter.compression, std::sqrt(2e-6), 1e-12);
  EXPECT_NEAR(scatter.s_par, 2 * std::sqrt(2e-6), 1e-12);
}

TEST(PackingScatter, OfSingleRunsIsUnknown) {
  const TestRecord a = run(0.70, 0), b = run(0.72, 0);
  const PackingScatter scatter = packing_scatter({{}, {&a, &b}, {}, {}}, kLaw, 0.675);
  EXPECT_EQ(scatter.packings, 1);
  EXPECT_TRUE(std::isnan(scatter.compression) && std::isnan(scatter.s_par) && std::isnan(scatter.F_par));
}

}  // namespace
}  // namespace grainlaw::fit
