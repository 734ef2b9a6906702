#include "fit/statistics/huber_loss.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {
namespace {

ResidualBlock values(const std::vector<double>& y) {
  ResidualBlock block;
  block.test = "values";
  block.weight = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(y.size()));
  block.channels = {{"y", 0, static_cast<int>(y.size()), 0, 10}};
  block.evaluate = [y](const double* x, double* r, double* J) {
    for (std::size_t i = 0; i < y.size(); ++i) r[i] = *x - y[i];
    if (J != nullptr) std::fill_n(J, y.size(), 1.0);
    return true;
  };
  return block;
}

Solution huber(const std::vector<double>& y) {
  return solve_huber({{{"x", 0, -100, 100, 1}}, {values(y)}}, 1, "huber", {});
}

// Seven values of scatter s = 1.4826 median|y - x| and one far away: sum of psi = 0, psi(u) = u up to c s, then c s.
TEST(Robust, AnOutlierPullsByNoMoreThanItsShare) {
  const std::vector<double> y{-3, -2, -1, 0, 1, 2, 3};
  for (const double far : {50.0, 5000.0}) {
    std::vector<double> with = y;
    with.push_back(far);
    const Solution s = huber(with);
    EXPECT_TRUE(s.converged) << s.termination;
    std::vector<double> off;
    for (const double v : with) off.push_back(std::abs(s.x(0) - v));
    std::sort(off.begin(), off.end());
    const double reach = 1.345 * 1.4826 * off[4];
    double pull = 0;
    for (const double v : with) pull += std::clamp(s.x(0) - v, -reach, reach);
    EXPECT_NEAR(pull, 0, 0.05 * reach) << far;
    EXPECT_LT(s.x(0), 1) << "their mean is " << far / 8;
    EXPECT_NEAR(s.weight(7), std::sqrt(reach / (far - s.x(0))), 2e-3);
  }
}

// Of white noise, here its quantiles: V = E psi^2/(n P(|u| < c)^2), 1/.95 of that of the mean (Huber 1964).
TEST(Robust, TheErrorIsThatOfItsEstimate) {
  constexpr int n = 400;
  const boost::math::normal normal;
  std::vector<ResidualBlock> packings;
  for (int i = 0; i < n; ++i) {
    packings.push_back(values({quantile(normal, (i + 0.5) / n)}));
    packings.back().cluster = i;
  }
  const StageFit fit = fit_stage("huber", "", {{{"x", 0, -100, 100, 1}}, packings, Loss::huber}, "", 1, {});
  const double error = fit.stage.estimates[0].estimate.standard_error;
  EXPECT_NEAR(n * error * error, 1 / 0.95, 0.01);
}

/// The value that packings have in common, of their rows; `absent` numbers are left out before the last packing's.
Estimate common_value(const std::vector<std::vector<double>>& rows, int absent = 0) {
  std::vector<ResidualBlock> packings;
  for (const std::vector<double>& y : rows) {
    packings.push_back(values(y));
    packings.back().cluster = static_cast<int>(packings.size()) - 1;
  }
  packings.back().cluster += absent;
  return fit_stage("huber", "", {{{"x", 0, -100, 100, 1}}, packings, Loss::huber}, "", 1, {})
      .stage.estimates[0]
      .estimate;
}

// Five packings, one of which moves away: where the loss begins to hold it a fifth of the information would be gone at once.
TEST(Robust, ErrorsDoNotJumpWhereARowIsHeld) {
  const auto error_of = [](double away) { return common_value({{-1}, {-0.8}, {0.8}, {1}, {away}}).standard_error; };
  double before = error_of(0);
  for (int k = 1; k <= 400; ++k) {
    const double error = error_of(0.01 * k);
    EXPECT_NEAR(error / before, 1, 0.03) << k;
    before = error;
  }
}

// Packings whose rows scatter more or less, each with a row in six that is far off on the same side, as a model's misfit is: by
// how much these pull, their scatter says. Variance beside that of the fits without each packing in turn.
TEST(Robust, TheErrorCountsThatTheReachIsMeasured) {
  std::vector<std::vector<double>> rows;
  for (int c = 0; c < 12; ++c) {
    std::vector<double> y(4, 50);
    for (int i = 0; i < 20; ++i) y.push_back((0.6 + 0.8 * c / 11) * quantile(boost::math::normal(), (i + 0.5) / 20));
    rows.push_back(y);
  }
  const double error = common_value(rows).standard_error;
  const double n = static_cast<double>(rows.size());
  double sum = 0, squares = 0;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    std::vector<std::vector<double>> others = rows;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
    const double x = common_value(others).value;
    sum += x;
    squares += x * x;
  }
  const double jackknife = std::sqrt((n - 1) / n * (squares - sum * sum / n));
  EXPECT_NEAR(error / jackknife, 1, 0.15);
  // a stage has the numbers of the whole calibration, of which some packings may have no rows of it
  EXPECT_NEAR(common_value(rows, 8).standard_error, error, 1e-9);
}

TEST(Robust, WithoutOutliersItIsTheMean) {
  const Solution s = huber({1, 2, 3, 4, 1, 2, 3, 4});
  EXPECT_NEAR(s.x(0), 2.5, 1e-7);  // about the square root of machine precision: the cost feels no less
  EXPECT_EQ(s.weight.minCoeff(), 1);
}

TEST(Robust, ExactDataKeepTheirWeights) {
  const Solution s = huber({2, 2, 2, 2});
  EXPECT_NEAR(s.x(0), 2, 1e-9);
  EXPECT_EQ(s.weight.minCoeff(), 1);
}

}  // namespace
}  // namespace grainlaw::fit
