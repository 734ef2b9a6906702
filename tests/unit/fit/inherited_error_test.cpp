#include "fit/statistics/inherited_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::fit {
namespace {

constexpr int kRowsOfRun = 20;
constexpr double kSlope = 3;  // of the second stage's misfit in the first one's parameter

/// Blocks of x[0] + shift - value, one for each run, whose rows all hold its value.
std::vector<ResidualBlock> blocks_of(const std::vector<double>& values, double shift) {
  std::vector<ResidualBlock> blocks;
  for (std::size_t c = 0; c < values.size(); ++c) {
    ResidualBlock block;
    block.test = "run";
    block.cluster = static_cast<int>(c);
    block.weight = Eigen::VectorXd::Ones(kRowsOfRun);
    block.channels.push_back({"value", 0, kRowsOfRun, 0, std::abs(values[c])});
    block.evaluate = [value = values[c], shift](const double* x, double* misfit, double* jacobian) {
      for (int i = 0; i < kRowsOfRun; ++i) misfit[i] = x[0] + shift - value;
      if (jacobian != nullptr) std::fill_n(jacobian, kRowsOfRun, 1.0);
      return true;
    };
    blocks.push_back(std::move(block));
  }
  return blocks;
}

StageFit mean_of(const std::string& name, const std::vector<double>& values, double shift) {
  return fit_stage(name, "", {{{name, 0.5, -100, 100, 1}}, blocks_of(values, shift)}, "", 1, {});
}

double variance(const StageFit& fit) { return std::pow(fit.stage.estimates[0].estimate.standard_error, 2); }

/// What b, the mean of y - slope a, owes to a by the parameters `given` of a law in which D is a.
void inherit(const StageFit& a, const std::vector<double>& y, double slope, StageFit& b,
             const std::string& given = "overlap.D") {
  FoundErrors found = no_errors();
  add_errors(a, found);
  LawParameters<double> law = start_parameters();
  law.overlap_D = a.solution.x(0);
  inherit_errors(
      {given}, found, law, [&](const LawParameters<double>& moved) { return blocks_of(y, slope * moved.overlap_D); }, 1,
      b);
}

// a is the mean of x, b that of y - 3 a: b = mean(y - 3 x), with the error of a mean of these differences.
TEST(InheritedError, IsThatOfBothStepsTogether) {
  const std::vector<double> x{1.0, 1.4, 0.7, 1.1, 0.9};
  for (const std::vector<double>& y :
       {std::vector<double>{2, 2, 2, 2, 2}, {2.0, 2.1, 1.8, 2.2, 1.9}, {1.8, 0.9, 2.9, 1.6, 2.4}}) {
    for (const std::string given : {"overlap.D", "overlap"}) {
      const StageFit a = mean_of("overlap.D", x, 0);
      StageFit b = mean_of("b", y, kSlope * a.solution.x(0));
      double mean = 0, expected = 0;
      for (std::size_t c = 0; c < x.size(); ++c) mean += (y[c] - kSlope * x[c]) / 5;
      for (std::size_t c = 0; c < x.size(); ++c) expected += std::pow(y[c] - kSlope * x[c] - mean, 2) / (5 * 4);
      EXPECT_NEAR(b.solution.x(0), mean, 1e-9);
      inherit(a, y, kSlope, b, given);
      EXPECT_NEAR(variance(b), expected, 1e-9 * expected);
      EXPECT_NEAR(b.covariance()(0, 0), expected, 1e-9 * expected);
      EXPECT_NEAR(b.stage.estimates[0].estimate.degrees_of_freedom, 4, 1e-9);
    }
  }
}

TEST(InheritedError, NothingChangesWithoutAnErrorToInherit) {
  const std::vector<double> y{2.0, 2.1, 1.8, 2.2, 1.9};
  StageFit a = mean_of("overlap.D", {1.0, 1.4, 0.7, 1.1, 0.9}, 0), b = mean_of("b", y, 0);
  const double before = variance(b);
  inherit(a, y, 0, b);
  EXPECT_EQ(variance(b), before) << "no slope";
  inherit(a, y, kSlope, b, "fabric");
  EXPECT_EQ(variance(b), before) << "not given";
  a.mark_not_identified("overlap.D", "for the test");
  inherit(a, y, kSlope, b);
  EXPECT_EQ(variance(b), before) << "not identified";
}

TEST(InheritedError, TheFewerPackingsDecide) {
  const std::vector<double> y{2.0, 2.1, 1.8, 2.2, 1.9};
  const StageFit a = mean_of("overlap.D", {1.0, 1.4, 0.7}, 0);  // the second stage has five
  StageFit b = mean_of("b", y, kSlope * a.solution.x(0));
  const Eigen::RowVectorXd own = b.influence.row(0);
  inherit(a, y, kSlope, b);
  EXPECT_NEAR(b.stage.estimates[0].estimate.degrees_of_freedom, 2, 1e-9);
  Eigen::RowVectorXd expected = own;
  expected.head(3) -= kSlope * a.influence.row(0);
  EXPECT_NEAR((b.influence.row(0) - expected).norm(), 0, 1e-9);
}

/// D x0 - value and x0 - 1, one pair for each packing: D moves the Jacobian, too.
std::vector<ResidualBlock> product_blocks(const std::vector<double>& values, double D) {
  std::vector<ResidualBlock> blocks;
  for (std::size_t c = 0; c < values.size(); ++c) {
    ResidualBlock block;
    block.test = "run";
    block.cluster = static_cast<int>(c);
    block.weight = Eigen::VectorXd::Ones(2);
    block.channels.push_back({"value", 0, 2, 0, 3});
    block.evaluate = [D, value = values[c]](const double* x, double* misfit, double* jacobian) {
      misfit[0] = D * x[0] - value;
      misfit[1] = x[0] - 1;
      if (jacobian != nullptr) jacobian[0] = D, jacobian[1] = 1;
      return true;
    };
    blocks.push_back(std::move(block));
  }
  return blocks;
}

// b = (D y + 1)/(D^2 + 1) with y the mean of the values, D the mean of x, each known by its packings:
//   b_c = db/dD D_c + db/dy y_c,   db/dD = y/(D^2 + 1) - 2 D b/(D^2 + 1)
TEST(InheritedError, TheWholeChangeOfTheGradientCounts) {
  const std::vector<double> x{1.0, 1.4, 0.7, 1.1, 0.9}, y{4.8, 3.9, 5.9, 4.6, 5.4};
  const StageFit a = mean_of("overlap.D", x, 0);
  LawParameters<double> law = start_parameters();
  const double D = law.overlap_D = a.solution.x(0);
  StageFit b = fit_stage("b", "", {{{"b", 0.5, -100, 100, 1}}, product_blocks(y, D)}, "", 1, {});
  FoundErrors found = no_errors();
  add_errors(a, found);
  inherit_errors(
      {"overlap"}, found, law, [&](const LawParameters<double>& given) { return product_blocks(y, given.overlap_D); },
      1, b);
  const double value = b.solution.x(0), mean_y = 4.92, square = D * D + 1, by_D = (mean_y - 2 * D * value) / square;
  EXPECT_NEAR(value, (D * mean_y + 1) / square, 1e-9);
  double expected = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
    expected += std::pow(by_D * (x[c] - D) + D / square * (y[c] - mean_y), 2) / (5 * 4);
  EXPECT_NEAR(variance(b), expected, 1e-5 * expected);
}

}  // namespace
}  // namespace grainlaw::fit
