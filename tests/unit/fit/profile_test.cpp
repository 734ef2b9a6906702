#include "fit/statistics/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/statistics/covariance.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

constexpr int kPackings = 4, kRows = 10;

double at(int i) { return 1 + static_cast<double>(i) / kRows; }

/// Scatter from packing to packing and from row to row, without a trend of its own.
double scatter(int packing, int i) {
  return 0.1 * std::sin(5.0 * packing + 1) + 0.05 * std::cos(7.0 * i * (packing + 1));
}

/// Blocks of model(x0, x1, t) - level - slope t - scatter; `model` sets value and derivatives.
template <class Model>
std::vector<ResidualBlock> blocks_of(const Model& model, double level, double slope) {
  std::vector<ResidualBlock> blocks;
  for (int packing = 0; packing < kPackings; ++packing) {
    ResidualBlock block;
    block.test = "test-" + std::to_string(packing);
    block.cluster = packing;
    block.weight = Eigen::VectorXd::Ones(kRows);
    block.channels = {{"y", 0, kRows, 0, 1}};
    block.evaluate = [=](const double* x, double* r, double* J) {
      for (int i = 0; i < kRows; ++i) {
        double d[2];
        r[i] = model(x, at(i), d) - level - slope * at(i) - scatter(packing, i);
        if (J != nullptr) J[2 * i] = d[0], J[2 * i + 1] = d[1];
      }
      return true;
    };
    blocks.push_back(std::move(block));
  }
  return blocks;
}

const auto kStraight = [](const double* x, double t, double* d) {
  d[0] = 1;
  d[1] = t;
  return x[0] + x[1] * t;
};

StageFit profiled(const std::vector<FreeParameter>& parameters, const std::vector<ResidualBlock>& blocks) {
  StageFit fit = fit_stage("stage", "", {parameters, blocks}, "look elsewhere", 1, {});
  profile_doubtful({parameters, blocks}, 1, {}, fit);
  return fit;
}

TEST(Profile, OfAStraightLineIsTheIntervalOfItsStandardError) {
  const std::vector<FreeParameter> parameters{{"level", 0, -10, 10, 1}, {"slope", 0, -10, 10, 1}};
  const StageFit fit = profiled(parameters, blocks_of(kStraight, 5, 0));
  const Estimate& slope = fit.stage.estimates[1].estimate;
  ASSERT_GE(slope.half_width(), std::abs(slope.value));
  ASSERT_EQ(fit.stage.profiles.size(), 1u) << "the level is certain";
  const Profile& profile = fit.stage.profiles[0];
  EXPECT_EQ(profile.parameter, "slope");
  EXPECT_EQ(profile.reason, "its interval contains zero");
  EXPECT_NEAR(profile.lower, slope.value - slope.half_width(), 1e-6 * slope.half_width());
  EXPECT_NEAR(profile.upper, slope.value + slope.half_width(), 1e-6 * slope.half_width());
  for (const ProfilePoint& p : profile.points)
    EXPECT_NEAR(p.excess, std::pow((p.value - slope.value) / slope.half_width(), 2), 1e-6);
  // Each packing has the same rows: a fifth one like them narrows the error to the root of 4/5.
  EXPECT_NE(profile.experiment.find("narrow it most, to 89 %"), std::string::npos) << profile.experiment;
}

// On the bound 0 of the slope, were it b < 0 without: C(x) - C(0) = S_tt (x^2/2 - b x), S_tt the scatter of t.
TEST(Profile, OfAParameterOnItsBoundHasItsOtherEnd) {
  const std::vector<FreeParameter> free{{"level", 0, -10, 10, 1}, {"slope", 0, -10, 10, 1}};
  const std::vector<FreeParameter> bounded{{"level", 0, -10, 10, 1}, {"slope", 1, 0, 10, 1}};
  const auto blocks = blocks_of(kStraight, 5, -0.2);
  const double b = fit_stage("free", "", {free, blocks}, "", 1, {}).solution.x(1);
  ASSERT_LT(b, 0);
  const StageFit fit = profiled(bounded, blocks);
  ASSERT_EQ(fit.stage.profiles.size(), 1u);
  const Profile& profile = fit.stage.profiles[0];
  EXPECT_EQ(profile.reason, "at its bound");
  EXPECT_TRUE(std::isnan(profile.lower));
  double S_tt = 0;
  for (int i = 0; i < kRows; ++i) S_tt += kPackings * std::pow(at(i) - (at(0) + at(kRows - 1)) / 2, 2);
  const Estimate& level = fit.stage.estimates[0].estimate;  // alone: naive variance 1/(all rows)
  const double inflation = std::pow(level.standard_error, 2) * kPackings * kRows;
  const double unit = std::pow(student_95(kPackings - 1), 2) * inflation / 2;
  const double expected = b + std::sqrt(b * b + 2 * unit / S_tt);
  EXPECT_NEAR(profile.upper, expected, 0.01 * expected);
}

// x0 + t exp(-x1) of data that fall a little: the slope wants to be zero, and any large x1 will do.
TEST(Profile, OfAParameterThatActsOnNothingIsNotBounded) {
  const auto decay = [](const double* x, double t, double* d) {
    d[0] = 1;
    d[1] = -t * std::exp(-x[1]);
    return x[0] + t * std::exp(-x[1]);
  };
  const std::vector<FreeParameter> parameters{{"level", 0, -10, 10, 1}, {"rate", 4, 0, 50, 10}};
  const StageFit fit = profiled(parameters, blocks_of(decay, 5, -0.05));
  const auto& profiles = fit.stage.profiles;
  const auto rate =
      std::find_if(profiles.begin(), profiles.end(), [](const Profile& p) { return p.parameter == "rate"; });
  ASSERT_NE(rate, profiles.end());
  EXPECT_TRUE(std::isnan(rate->upper));
  EXPECT_GT(rate->lower, 0.1);
  EXPECT_LT(rate->lower, 10);
}

TEST(Profile, WhereTheModelIsNotDefinedThereIsNoExcess) {
  const std::vector<FreeParameter> parameters{{"level", 5, -10, 10, 1}, {"slope", 0, -10, 10, 1}};
  const Estimate slope = profiled(parameters, blocks_of(kStraight, 5, 0)).stage.estimates[1].estimate;
  const double defined = slope.value + 0.9 * slope.half_width();
  const auto partly = [&](const double* x, double t, double* d) {
    const double y = kStraight(x, t, d);
    return x[1] > defined ? std::nan("") : y;
  };
  const StageFit fit = profiled(parameters, blocks_of(partly, 5, 0));
  ASSERT_EQ(fit.stage.profiles.size(), 1u);
  const Profile& profile = fit.stage.profiles[0];
  EXPECT_TRUE(std::isnan(profile.upper));
  EXPECT_NEAR(profile.lower, slope.value - slope.half_width(), 1e-6 * slope.half_width());
  int beyond = 0;
  for (const ProfilePoint& p : profile.points) {
    if (p.value <= defined) continue;
    ++beyond;
    EXPECT_TRUE(std::isnan(p.excess)) << p.value;
  }
  EXPECT_GT(beyond, 0);
}

// Its weights follow the fit: a refit by squares is another cost, far above it everywhere.
TEST(Profile, NoneByHubersLoss) {
  const std::vector<FreeParameter> parameters{{"level", 0, -10, 10, 1}, {"slope", 0, -10, 10, 1}};
  const Problem problem{parameters, blocks_of(kStraight, 5, 0), Loss::huber};
  StageFit fit = fit_stage("stage", "", problem, "look elsewhere", 1, {});
  profile_doubtful(problem, 1, {}, fit);
  EXPECT_TRUE(fit.stage.profiles.empty());
}

TEST(Profile, OnlyOfWhatIsDoubtful) {
  EXPECT_EQ(doubt({1, 0.1, Status::fitted, "", 5}), "");
  EXPECT_NE(doubt({1, 0.5, Status::fitted, "", 5}), "");  // t = 2.57
  EXPECT_EQ(doubt({1, std::nan(""), Status::fitted, ""}), "");
  EXPECT_NE(doubt({0, std::nan(""), Status::at_bound, ""}), "");
  EXPECT_NE(doubt({0, std::nan(""), Status::not_identified, ""}), "");
  EXPECT_EQ(doubt({0, std::nan(""), Status::fixed, ""}), "");
}

}  // namespace
}  // namespace grainlaw::fit
