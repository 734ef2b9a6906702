#include "fit/statistics/search.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::fit {
namespace {

/// (y^2 - 1)^2 + (0.3 (y + 1))^2 is zero at -1 and has another minimum near +1.
ResidualBlock two_minima() {
  ResidualBlock block;
  block.test = "two";
  block.weight = Eigen::VectorXd::Ones(2);
  block.channels = {{"y", 0, 2, 0, 1}};
  block.evaluate = [](const double* y, double* r, double* J) {
    r[0] = *y * *y - 1;
    r[1] = 0.3 * (*y + 1);
    if (J != nullptr) J[0] = 2 * *y, J[1] = 0.3;
    return true;
  };
  return block;
}

TEST(ManyStarts, FindTheLowerOfTwoMinima) {
  const std::vector<FreeParameter> from{{"y", 0, -3, 3, 3}};
  const auto run = [&](double start, int starts, StartSearch& search) {
    std::vector<FreeParameter> p = from;
    p[0].start = start;
    return minimise({p, {two_minima()}}, starts, 1, "two", {}, search);
  };
  StartSearch one, many;
  const Solution upper = run(0.8, 1, one);
  EXPECT_GT(upper.x(0), 0.8);
  EXPECT_EQ(one.tried, 1);
  const Solution lower = run(0, 20, many);
  EXPECT_NEAR(lower.x(0), -1, 1e-6);
  EXPECT_LT(lower.final_cost, upper.final_cost);
  EXPECT_EQ(many.tried, 20);
  EXPECT_GT(many.at_minimum, 0);
  EXPECT_LT(many.at_minimum, 20);
  EXPECT_NEAR(many.next_cost, upper.final_cost, 1e-9);
}

TEST(ManyStarts, LieWithinTheirRangeAndTheFirstIsTheGivenOne) {
  const std::vector<FreeParameter> from{{"pressure.p0", 0.04, 0, 1, 0.04},
                                        {"pressure.nu_c", 0.665, 0.5, 0.668, 0.6},
                                        {"fabric_max.Q_limit", 0, 0, 1, 0.3}};
  EXPECT_EQ(start_number(from, 0)[0].start, 0.04);
  double least = 1, largest = 0;
  for (int i = 1; i < 200; ++i) {
    const auto p = start_number(from, i);
    least = std::min(least, p[0].start);
    largest = std::max(largest, p[0].start);
    EXPECT_NEAR(p[1].start, 0.665, 0.005);
    EXPECT_LE(p[1].start, 0.668);
    EXPECT_GE(p[2].start, 0);
    EXPECT_LE(p[2].start, 0.1);
    EXPECT_EQ(p[0].start, start_number(from, i)[0].start);
  }
  EXPECT_GT(least, 0.04 / 3);
  EXPECT_LT(least, 0.04 / 2.8);
  EXPECT_LT(largest, 0.04 * 3);
  EXPECT_GT(largest, 0.04 * 2.8);
}

}  // namespace
}  // namespace grainlaw::fit
