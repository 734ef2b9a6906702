#include "fit/statistics/stage_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

/// misfit = x0 + x1 - y, rows of which `shown` more than fitted ones.
ResidualBlock sum_block(const std::string& test, int cluster, const std::vector<double>& y, bool fitted = true) {
  ResidualBlock block;
  block.test = test;
  block.cluster = cluster;
  block.weight = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(y.size()), fitted ? 2.0 : 0.0);
  block.channels = {{fitted ? "y" : "shown", 0, static_cast<int>(y.size()), 3, 9}};
  block.evaluate = [y](const double* x, double* r, double* J) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      r[i] = x[0] + x[1] - y[i];
      if (J != nullptr) J[2 * i] = J[2 * i + 1] = 1;
    }
    return true;
  };
  return block;
}

const std::vector<FreeParameter> kTwo{{"one", 0, -10, 10, 1}, {"two", 0, -10, 10, 1}};

TEST(StageFit, SaysWhatIsNotDeterminedAndHowTestsAreMet) {
  const StageFit fit = fit_stage(
      "sum", "all", {kTwo, {sum_block("a", 0, {1, 1}), sum_block("b", 1, {3, 3}), sum_block("a", 0, {5}, false)}},
      "separate them", 1, {});
  EXPECT_TRUE(fit.stage.converged);
  EXPECT_EQ(fit.stage.residuals, 4);
  for (const NamedEstimate& e : fit.stage.estimates) {
    EXPECT_EQ(e.estimate.status, Status::not_identified);
    EXPECT_EQ(e.estimate.note, "separate them");
    EXPECT_TRUE(std::isnan(e.estimate.standard_error));
  }
  EXPECT_EQ(fit.covariance().norm(), 0);
  // x0 + x1 = 2: misfits +1, -1 in the unit of the data, whatever the weight; -3 where it is only shown. To 1e-8: beyond
  // the square root of machine precision the cost no longer feels a change of x.
  ASSERT_EQ(fit.stage.tests.size(), 3u);
  EXPECT_NEAR(fit.stage.tests[0].bias, 1, 1e-8);
  EXPECT_NEAR(fit.stage.tests[0].rms, 1, 1e-8);
  EXPECT_EQ(fit.stage.tests[0].rows, 2);
  EXPECT_EQ(fit.stage.tests[0].rows_excluded, 3);
  EXPECT_EQ(fit.stage.tests[0].max_abs_data, 9);
  EXPECT_NEAR(fit.stage.tests[1].bias, -1, 1e-8);
  EXPECT_TRUE(fit.stage.tests[1].in_cost);
  EXPECT_FALSE(fit.stage.tests[2].in_cost);
  EXPECT_NEAR(fit.stage.tests[2].bias, -3, 1e-8);
}

TEST(StageFit, AParameterOnItsBoundHasNoError) {
  std::vector<FreeParameter> parameters = kTwo;
  parameters[1] = {"two", 0, -1, 0.5, 1};
  parameters[0] = {"one", 0, -10, 0.25, 1};
  const StageFit fit =
      fit_stage("sum", "all", {parameters, {sum_block("a", 0, {1}), sum_block("b", 1, {3})}}, "", 1, {});
  for (const NamedEstimate& e : fit.stage.estimates) {
    EXPECT_EQ(e.estimate.status, Status::at_bound);
    EXPECT_TRUE(std::isnan(e.estimate.standard_error));
    EXPECT_NE(e.estimate.note.find("bound"), std::string::npos);
  }
}

TEST(StageFit, ClaimsCanBeWithdrawn) {
  const auto mean_block = [](const std::string& test, int cluster, double y) {
    ResidualBlock block;
    block.test = test;
    block.cluster = cluster;
    block.weight = Eigen::VectorXd::Ones(1);
    block.channels = {{"y", 0, 1, 0, y}};
    block.evaluate = [y](const double* x, double* r, double* J) {
      r[0] = x[0] - y;
      if (J != nullptr) J[0] = 1;
      return true;
    };
    return block;
  };
  StageFit fit =
      fit_stage("mean", "all", {{{"one", 0, -10, 10, 1}}, {mean_block("a", 0, 1), mean_block("b", 1, 3)}}, "", 1, {});
  // Mean of two runs, 1 and 3: standard error 1.
  EXPECT_EQ(fit.stage.estimates[0].estimate.status, Status::fitted);
  EXPECT_NEAR(fit.stage.estimates[0].estimate.standard_error, 1, 1e-8);
  EXPECT_NEAR(fit.stage.estimates[0].estimate.degrees_of_freedom, 1, 1e-8);
  // Student's t of one degree of freedom is Cauchy's distribution: tan(pi (0.975 - 1/2)).
  EXPECT_NEAR(fit.stage.estimates[0].estimate.half_width(), std::tan(std::numbers::pi * 0.475), 1e-6);
  fit.mark_not_identified("one", "because");
  EXPECT_EQ(fit.stage.estimates[0].estimate.status, Status::not_identified);
  EXPECT_TRUE(std::isnan(fit.stage.estimates[0].estimate.half_width()));
  EXPECT_EQ(fit.covariance().norm(), 0);
  EXPECT_THROW(fit.mark_not_identified("three", ""), Error);
}

TEST(StageFit, StatusHasAWord) {
  EXPECT_EQ(to_string(Status::fitted), "fitted");
  EXPECT_EQ(to_string(Status::fixed), "fixed");
  EXPECT_EQ(to_string(Status::tied), "tied");
  EXPECT_EQ(to_string(Status::at_bound), "at_bound");
  EXPECT_EQ(to_string(Status::not_identified), "not_identified");
}

/// x and x^2 of one packing, measured as a and b.
ResidualBlock parabola_block(int cluster, double a, double b) {
  ResidualBlock block;
  block.test = "parabola";
  block.cluster = cluster;
  block.weight = Eigen::VectorXd::Ones(2);
  block.channels = {{"y", 0, 2, 0, 1}};
  block.evaluate = [a, b](const double* x, double* r, double* J) {
    r[0] = x[0] - a;
    r[1] = x[0] * x[0] - b;
    if (J != nullptr) J[0] = 1, J[1] = 2 * x[0];
    return true;
  };
  return block;
}

// A model that cannot meet its data, x near the mean of a and x^2 near that of b. For the gradient
//   g(x) = sum_c (x - a_c) + 2 x (x^2 - b_c) = 0
// a packing moves x by -(its own part)/g'(x), g' = G (1 + 6 x^2 - 2 mean b); G packings that weigh alike: times
// sqrt(G/(G-1)).
TEST(StageFit, ErrorsKnowThatTheModelDoesNotHold) {
  const std::vector<double> a{1.0, 1.1, 0.85, 1.02}, b{-1.0, -1.04, -0.95, -1.02};
  std::vector<ResidualBlock> blocks;
  for (std::size_t c = 0; c < a.size(); ++c) blocks.push_back(parabola_block(static_cast<int>(c), a[c], b[c]));
  const StageFit fit = fit_stage("parabola", "", {{{"x", 1, -10, 10, 1}}, blocks}, "", 1, {});
  const double x = fit.solution.x(0), G = 4, mean_b = (b[0] + b[1] + b[2] + b[3]) / G;
  const double second = G * (1 + 6 * x * x - 2 * mean_b), without = G * (1 + 4 * x * x);
  ASSERT_LT(without, 0.5 * second);
  double variance = 0;
  for (std::size_t c = 0; c < a.size(); ++c)
    variance += G / (G - 1) * std::pow(((x - a[c]) + 2 * x * (x * x - b[c])) / second, 2);
  EXPECT_NEAR(fit.stage.estimates[0].estimate.standard_error, std::sqrt(variance), 1e-5 * std::sqrt(variance));
  EXPECT_NEAR(fit.stage.estimates[0].estimate.degrees_of_freedom, G - 1, 1e-6);
}

}  // namespace
}  // namespace grainlaw::fit
