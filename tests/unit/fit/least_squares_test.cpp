#include "fit/statistics/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/parameters.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

/// Straight line through (t_i, y_i): misfit x0 + x1 t - y.
ResidualBlock line(const std::vector<double>& t, const std::vector<double>& y, int cluster = 0) {
  ResidualBlock block;
  block.test = "line";
  block.cluster = cluster;
  block.weight = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(t.size()));
  block.channels = {{"y", 0, static_cast<int>(t.size()), 0, 1}};
  block.evaluate = [t, y](const double* x, double* r, double* J) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      r[i] = x[0] + x[1] * t[i] - y[i];
      if (J != nullptr) {
        J[2 * i] = 1;
        J[2 * i + 1] = t[i];
      }
    }
    return true;
  };
  return block;
}

constexpr double kTight = 1e-8;  // the cost feels a change of x from the square root of machine precision on
const std::vector<FreeParameter> kLine{{"intercept", 0, -100, 100, 1}, {"slope", 0, -100, 100, 1}};

TEST(LeastSquares, RegressionLineInClosedForm) {
  // Normal equations by hand: t = 0,1,2, y = 1,2,4 -> slope 3/2, intercept 5/6, cost 1/2 (1/36 + 4/36 + 1/36) = 1/12.
  const Solution s = solve({kLine, {line({0, 1, 2}, {1, 2, 4})}}, 1, "line", {});
  EXPECT_TRUE(s.converged) << s.termination;
  EXPECT_NEAR(s.x(0), 5. / 6, kTight);
  EXPECT_NEAR(s.x(1), 3. / 2, kTight);
  EXPECT_NEAR(s.final_cost, 1. / 12, 1e-14);
  EXPECT_NEAR(s.initial_cost, 21. / 2, 1e-12);
}

TEST(LeastSquares, WeightOfZeroShowsARowWithoutFittingIt) {
  ResidualBlock block = line({0, 1, 2}, {1, 2, 100});
  block.weight(2) = 0;
  const Solution s = solve({kLine, {block}}, 1, "line", {});
  EXPECT_TRUE(s.converged);
  EXPECT_NEAR(s.x(0), 1, kTight);
  EXPECT_NEAR(s.x(1), 1, kTight);
  EXPECT_NEAR(s.misfit(2), -97, 1e-10);
}

TEST(LeastSquares, HoldsWhatABoundHoldsBack) {
  // Slope at most 1: then the intercept is the mean of y - t = (1 + 1 + 2)/3.
  std::vector<FreeParameter> bounded = kLine;
  bounded[1].upper = 1;
  const Solution s = solve({bounded, {line({0, 1, 2}, {1, 2, 4})}}, 1, "line", {});
  EXPECT_TRUE(s.converged) << s.termination;
  EXPECT_EQ(s.x(1), 1);
  EXPECT_NEAR(s.x(0), 4. / 3, kTight);
  EXPECT_FALSE(s.at_bound[0]);
  EXPECT_TRUE(s.at_bound[1]);
}

TEST(LeastSquares, LetsGoOfABoundThatItStartsOn) {
  std::vector<FreeParameter> bounded = kLine;
  bounded[1] = {"slope", -3, -3, 100, 1};
  const Solution s = solve({bounded, {line({0, 1, 2}, {1, 2, 4})}}, 1, "line", {});
  EXPECT_TRUE(s.converged);
  EXPECT_NEAR(s.x(1), 3. / 2, kTight);
  EXPECT_FALSE(s.at_bound[1]);
}

TEST(LeastSquares, DigitsDoNotDependOnThreads) {
  std::vector<ResidualBlock> blocks;
  for (int b = 0; b < 13; ++b) {
    std::vector<double> t, y;
    for (int i = 0; i < 7; ++i) {
      t.push_back(0.1 * i + b);
      y.push_back(std::sin(1.7 * i + 0.3 * b));
    }
    blocks.push_back(line(t, y, b));
  }
  const Solution one = solve({kLine, blocks}, 1, "line", {}), many = solve({kLine, blocks}, 5, "line", {});
  EXPECT_EQ(one.x, many.x);
  EXPECT_EQ(one.final_cost, many.final_cost);
  EXPECT_EQ(one.jacobian, many.jacobian);
  EXPECT_EQ(one.cluster, many.cluster);
}

TEST(LeastSquares, NamesTheRowWithoutAValue) {
  ResidualBlock block = line({0, 1}, {0, 1});
  block.evaluate = [](const double*, double* r, double* J) {
    r[0] = 0;
    r[1] = std::nan("");
    if (J != nullptr) std::fill(J, J + 4, 0.0);
    return true;
  };
  const Solution s = solve({kLine, {block}}, 1, "line", {});
  EXPECT_FALSE(s.converged);
  EXPECT_FALSE(s.defined);
  EXPECT_NE(s.termination.find("test line, row 2 of the fit"), std::string::npos) << s.termination;
  EXPECT_NE(s.termination.find("slope = 0"), std::string::npos) << s.termination;
}

TEST(LeastSquares, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  EXPECT_THROW(solve({kLine, {line({0, 1}, {0, 1})}}, 1, "line", control), Interrupted);
}

TEST(LeastSquares, TakesBoundsFromTheParameterTable) {
  const FreeParameter p = free_parameter("pressure.p0", 0.05);
  const ParameterInfo& info = parameter_table()[parameter_index("pressure.p0")];
  EXPECT_EQ(p.lower, info.lower);
  EXPECT_EQ(p.upper, info.upper);
  EXPECT_GT(p.scale, 0);
  EXPECT_GT(free_parameter("pressure.gamma_p", 0).scale, 0);
  EXPECT_THROW(free_parameter("pressure.p1", 0), InvalidInput);
}

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
    const Eigen::MatrixXd S = curvature({kParameters, growth()}, at(x0, x1), threads);
    EXPECT_NEAR(S(0, 0), 0, 1e-6 * std::abs(cross));
    EXPECT_NEAR(S(0, 1), cross, 1e-5 * std::abs(cross));
    EXPECT_EQ(S(0, 1), S(1, 0));
    EXPECT_NEAR(S(1, 1), own, 1e-5 * std::abs(own));
  }
}

TEST(Curvature, ARowThatIsHeldDoesNotBendTheCost) {
  Solution solution = at(0.7, 0.2);
  const Eigen::MatrixXd free = curvature({kParameters, growth()}, solution, 1);
  solution.pull_slope(1) = 0;
  const Eigen::RowVector2d slope = solution.jacobian.row(1);
  EXPECT_TRUE(curvature({kParameters, growth()}, solution, 1).isApprox(free - 9 * slope.transpose() * slope, 1e-14));
}

TEST(Curvature, NothingOfAParameterOnItsBound) {
  const Eigen::MatrixXd S = curvature({kParameters, growth()}, at(0.7, 0.25), 1);
  EXPECT_EQ(S.row(1).norm(), 0);
  EXPECT_EQ(S.col(1).norm(), 0);
}

}  // namespace
}  // namespace grainlaw::fit
