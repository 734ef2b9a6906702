#include "fit/statistics/curvature.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::fit {
namespace {

/// misfit = x0 exp(x1 t) - t at t = 1, 2, weights 1 and 3.
std::vector<ResidualBlock> growth() {
  ResidualBlock block;
  block.test = "growth";
  block.weight = Eigen::Vector2d(1, 3);
  block.channels = {{"y", 0, 2, 0, 2}};
  block.evaluate = [](const double* x, double* r, double* J) {
    for (int i = 0; i < 2; ++i) {
      const double t = i + 1, e = std::exp(x[1] * t);
      r[i] = x[0] * e - t;
      if (J != nullptr) J[2 * i] = e, J[2 * i + 1] = x[0] * t * e;
    }
    return true;
  };
  return {block};
}

const std::vector<FreeParameter> kParameters{{"level", 0, -10, 10, 1}, {"rate", 0, -10, 0.25, 1}};

Solution at(double level, double rate) {
  Solution solution;
  solution.x = Eigen::Vector2d(level, rate);
  solution.at_bound = {false, rate == 0.25};
  solution.weight = Eigen::Vector2d(1, 3);
  solution.pull_slope = Eigen::Vector2d(1, 1);
  solution.misfit.resize(2);
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> J;
  EXPECT_TRUE(evaluate(growth(), solution.x, 1, solution.misfit.data(), J.data()));
  solution.jacobian = J;
  return solution;
}

// d2/dx0 dx1 = t e, d2/dx1^2 = x0 t^2 e with e = exp(x1 t), and none of x0 alone.
TEST(Curvature, IsTheWeightedSumOfMisfitsAndTheirSecondDerivatives) {
  const double x0 = 0.7, x1 = 0.2;
  double cross = 0, own = 0;
  for (const double t : {1.0, 2.0}) {
    const double w2 = t == 1 ? 1 : 9, e = std::exp(x1 * t), misfit = x0 * e - t;
    cross += w2 * misfit * t * e;
    own += w2 * misfit * x0 * t * t * e;
  }
  for (const int threads : {1, 2}) {
    const Eigen::MatrixXd S = curvature(kParameters, growth(), at(x0, x1), threads);
    EXPECT_NEAR(S(0, 0), 0, 1e-6 * std::abs(cross));
    EXPECT_NEAR(S(0, 1), cross, 1e-5 * std::abs(cross));
    EXPECT_EQ(S(0, 1), S(1, 0));
    EXPECT_NEAR(S(1, 1), own, 1e-5 * std::abs(own));
  }
}

TEST(Curvature, ARowThatIsHeldDoesNotBendTheCost) {
  Solution solution = at(0.7, 0.2);
  const Eigen::MatrixXd free = curvature(kParameters, growth(), solution, 1);
  solution.pull_slope(1) = 0;
  const Eigen::RowVector2d slope = solution.jacobian.row(1);
  EXPECT_TRUE(curvature(kParameters, growth(), solution, 1).isApprox(free - 9 * slope.transpose() * slope, 1e-14));
}

TEST(Curvature, NothingOfAParameterOnItsBound) {
  const Eigen::MatrixXd S = curvature(kParameters, growth(), at(0.7, 0.25), 1);
  EXPECT_EQ(S.row(1).norm(), 0);
  EXPECT_EQ(S.col(1).norm(), 0);
}

}  // namespace
}  // namespace grainlaw::fit
