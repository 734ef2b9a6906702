#include "model/vocabulary/path.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "model/vocabulary/error.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw {
namespace {

using testing::kInfinity;
using testing::kNaN;
using testing::path_of;

PathSegment segment(Mode mode, ExtentKind kind, double extent, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), kind, extent};
}

/// The message with which `path` is refused; empty when it is accepted.
std::string refusal(const Path& path) {
  try {
    resolve(path);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(Path, DirectionsAreThoseOfThePaper) {
  const auto rate = [](Mode mode) { return Eigen::Vector3d(direction_of(mode).tensor.diagonal()); };
  EXPECT_EQ(rate(Mode::ISO), Eigen::Vector3d(-1, -1, -1));
  EXPECT_EQ(rate(Mode::UNI), Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(rate(Mode::D2), Eigen::Vector3d(1, 0, -1));
  EXPECT_EQ(rate(Mode::D3), Eigen::Vector3d(0.5, 0.5, -1));
}

TEST(Path, AxesAndReversal) {
  EXPECT_EQ(Eigen::Vector3d(direction_of(Mode::D2, "yzx").tensor.diagonal()), Eigen::Vector3d(-1, 1, 0));
  EXPECT_EQ(Eigen::Vector3d(direction_of(Mode::UNI, "zyx", true).tensor.diagonal()), Eigen::Vector3d(1, 0, 0));
  for (const char* axes : {"", "xy", "xyzz", "xxz", "abc", "XYZ"}) {
    EXPECT_THROW(direction_of(Mode::D2, axes), InvalidInput) << axes;
  }
  EXPECT_THROW(direction_of(Mode::tensor), InvalidInput);
}

TEST(Path, ExtentsBecomeLengths) {
  EXPECT_NEAR(resolve(path_of(0.7, {segment(Mode::D2, ExtentKind::eps_dev, 0.3)}))[0].length, 0.3 / std::sqrt(3.0),
              1e-15);
  EXPECT_NEAR(resolve(path_of(0.7, {segment(Mode::D3, ExtentKind::eps_dev, 0.3)}))[0].length, 0.2, 1e-15);
  EXPECT_NEAR(resolve(path_of(0.7, {segment(Mode::UNI, ExtentKind::eps_dev, 0.1)}))[0].length, 0.1, 1e-15);
  EXPECT_NEAR(resolve(path_of(0.7, {segment(Mode::ISO, ExtentKind::eps_vol, 0.03)}))[0].length, 0.01, 1e-15);
  EXPECT_NEAR(resolve(path_of(0.7, {segment(Mode::ISO, ExtentKind::eps_vol, 0.03, true)}))[0].length, 0.01, 1e-15);
}

TEST(Path, UniaxialDeviatoricStrainIsTheVolumetricOne) {
  // UNI: eps_dev = |eps_vol| = ln(nu/nu_0)
  const auto uni = resolve(path_of(0.695, {segment(Mode::UNI, ExtentKind::target_nu, 0.82)})).at(0);
  EXPECT_NEAR(uni.length, std::log(0.82 / 0.695), 1e-15);
  EXPECT_NEAR(deviatoric_norm(uni.strain(uni.length).tensor), std::log(0.82 / 0.695), 1e-15);
  EXPECT_NEAR(uni.nu(uni.length), 0.82, 1e-15);
  EXPECT_NEAR(uni.strain(uni.length).tensor.trace(), -std::log(0.82 / 0.695), 1e-15);
}

TEST(Path, SegmentsContinueEachOther) {
  const auto s = resolve(
      path_of(0.70, {segment(Mode::D2, ExtentKind::eps_dev, 0.15), segment(Mode::ISO, ExtentKind::target_nu, 0.73),
                     segment(Mode::ISO, ExtentKind::target_nu, 0.70, true)}));
  ASSERT_EQ(s.size(), 3U);
  EXPECT_EQ(s[0].nu(s[0].length), 0.70) << "constant volume";
  for (std::size_t k = 0; k + 1 < s.size(); ++k) {
    EXPECT_NEAR(s[k].nu(s[k].length), s[k + 1].nu_start, 1e-15);
    EXPECT_LE((s[k].strain(s[k].length).tensor - s[k + 1].strain_start.tensor).norm(), 1e-15);
  }
  EXPECT_NEAR(s[2].nu(s[2].length), 0.70, 1e-15);
  EXPECT_LE((s[2].strain(s[2].length).tensor - s[0].strain(s[0].length).tensor).norm(), 1e-15) << "there and back";
}

TEST(Path, ShearDirectionIsThatOfTheFirstSegmentWithADeviator) {
  const auto s = resolve(
      path_of(0.70, {segment(Mode::ISO, ExtentKind::target_nu, 0.73), segment(Mode::D3, ExtentKind::eps_dev, 0.1),
                     segment(Mode::D2, ExtentKind::eps_dev, 0.1)}));
  const Deviator<double> N = shear_direction(s);
  EXPECT_NEAR(N.norm(), 1, 1e-15);
  EXPECT_GT(N.dot(deviator<double>(Eigen::Matrix3d(Eigen::Vector3d(0, 0, 1).asDiagonal()))), 0.99)
      << "compression of z is positive";
  EXPECT_TRUE(shear_direction(resolve(path_of(0.70, {segment(Mode::ISO, ExtentKind::target_nu, 0.73)}))).isZero());
}

TEST(Path, RatesOfASegment) {
  const auto uni = resolve(path_of(0.70, {segment(Mode::UNI, ExtentKind::eps_vol, 0.1)})).at(0);
  EXPECT_NEAR(uni.eps_dev_rate(), 1, 1e-15);
  EXPECT_NEAR(uni.eps_vol_rate(), -1, 1e-15);
}

TEST(Path, RefusesExtentsThatTheDirectionCannotReach) {
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::ISO, ExtentKind::eps_dev, 0.1)})).find("segments[0]"),
            std::string::npos);
  EXPECT_NE(
      refusal(path_of(0.7, {segment(Mode::D2, ExtentKind::eps_dev, 0.1), segment(Mode::D2, ExtentKind::eps_vol, 0.1)}))
          .find("segments[1]"),
      std::string::npos);
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::D3, ExtentKind::target_nu, 0.8)})), "");
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::UNI, ExtentKind::target_nu, 0.65)})), "")
      << "compression to a smaller nu";
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::UNI, ExtentKind::target_nu, 0.75, true)})), "");
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::UNI, ExtentKind::target_nu, 0.7)})), "") << "nothing to do";
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::UNI, ExtentKind::target_nu, 0.95)})), "");
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::ISO, ExtentKind::eps_vol, 0.3)})), "") << "nu = 0.945";
}

TEST(Path, RefusesNumbersThatAreNone) {
  for (const double bad : {kNaN, kInfinity, -0.1, 0.0, -kInfinity}) {
    EXPECT_NE(refusal(path_of(0.7, {segment(Mode::D2, ExtentKind::eps_dev, bad)})), "") << bad;
    EXPECT_NE(refusal(path_of(bad, {segment(Mode::D2, ExtentKind::eps_dev, 0.1)})), "") << bad;
  }
  EXPECT_NE(refusal(path_of(0.91, {})), "");
  PathSegment still{Mode::tensor, {}, ExtentKind::eps_dev, 0.1};
  EXPECT_NE(refusal(path_of(0.7, {still})), "") << "no direction";
  still.direction.tensor(0, 0) = kNaN;
  EXPECT_NE(refusal(path_of(0.7, {still})), "");
}

TEST(Path, TargetOfEpsDevCountsFromTheStart) {
  const auto to = [](double target, bool reverse = false) {
    return segment(Mode::D2, ExtentKind::target_eps_dev, target, reverse);
  };
  const auto s = resolve(path_of(0.7, {to(0.1), to(0.3), to(0.2, true), to(0.25)}));
  const double expected[] = {0.1, 0.2, 0.1, 0.05};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(s[k].length * std::sqrt(3.0), expected[k], 1e-15) << k;
  // D2 about another axis meets the circle |eps'| = t at right angles no more: against the definition
  PathSegment oblique{Mode::D2, direction_of(Mode::D2, "zxy"), ExtentKind::target_eps_dev, 0.35};
  const auto bent = resolve(path_of(0.7, {to(0.3), oblique}));
  EXPECT_NEAR(deviatoric_norm(bent[1].strain(bent[1].length).tensor), 0.35, 1e-15);
  EXPECT_NE(refusal(path_of(0.7, {to(0.3), to(0.1)})).find("segments[1].extent: target_eps_dev 0.1"), std::string::npos)
      << "lies behind";
  EXPECT_NE(refusal(path_of(0.7, {segment(Mode::ISO, ExtentKind::target_eps_dev, 0.1)})), "");
}

TEST(Path, WhatTheLawDecidesIsCheckedButNotResolved) {
  PathSegment triaxial{Mode::UNI, direction_of(Mode::UNI), ExtentKind::eps_dev, 0.1};
  triaxial.conditions = {{0, Condition::Quantity::stress, 0}, {1, Condition::Quantity::stress, 0}};
  const PathSegment first = segment(Mode::D2, ExtentKind::eps_dev, 0.1);
  for (const PathSegment& open : {triaxial, segment(Mode::ISO, ExtentKind::target_P_star, 0.05),
                                  segment(Mode::D2, ExtentKind::target_stress_ratio, 0.1)}) {
    EXPECT_TRUE(law_decides(open));
    EXPECT_TRUE(law_decides(path_of(0.7, {first, open})));
    EXPECT_NO_THROW(check(path_of(0.7, {first, open, first})));
    EXPECT_NE(refusal(path_of(0.7, {first, open, first})).find("segments[1]: its "), std::string::npos);
  }
  EXPECT_FALSE(law_decides(path_of(0.7, {first})));

  const auto wrong = [](const PathSegment& open) {
    try {
      check(path_of(0.7, {open}));
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  PathSegment bad = triaxial;
  bad.conditions[0].free = 2;
  EXPECT_NE(wrong(bad).find("segments[0].free: zz is free and has a rate too"), std::string::npos);
  bad = triaxial;
  bad.conditions[1].free = 0;
  EXPECT_NE(wrong(bad).find("xx is given twice"), std::string::npos);
  bad.conditions = {{Condition::volume, Condition::Quantity::stress, 0}};
  EXPECT_NE(wrong(bad).find("volume: a stress is held"), std::string::npos);
  bad.conditions = {{0, Condition::Quantity::P_star, kNaN}};
  EXPECT_NE(wrong(bad), "");
  bad = triaxial;
  bad.extent = 0;
  EXPECT_NE(wrong(bad), "");
}

TEST(Path, FreeDirections) {
  EXPECT_EQ(free_direction({Condition::volume}).tensor.trace(), 1);
  EXPECT_EQ(deviatoric_norm(free_direction({Condition::volume}).tensor), 0);
  const Eigen::Matrix3d yz = free_direction({3}).tensor;
  EXPECT_EQ(yz(1, 2), 1);
  EXPECT_EQ(yz(2, 1), 1);
  EXPECT_EQ(yz.cwiseAbs().sum(), 2);
  EXPECT_EQ(free_name({0}) + free_name({5}) + free_name({Condition::volume}), "xxxyvolume");
}

TEST(Path, IsTheSameHoweverItIsWritten) {
  const auto path = [](std::vector<PathSegment> segments, double nu = 0.7) {
    return resolve({nu, Branch::unloading, std::move(segments)});
  };
  const auto of = [](double unit, double length) {
    PathSegment s = segment(Mode::D2, ExtentKind::eps_dev, length);
    s.mode = Mode::tensor;
    s.direction.tensor *= unit;
    return s;
  };
  const auto D2 = path({segment(Mode::D2, ExtentKind::eps_dev, 0.1)});
  EXPECT_TRUE(same_path(D2, path({of(2, 0.1)})));
  EXPECT_TRUE(same_path(D2, path({of(1, 0.03), of(3, 0.07)}))) << "in two parts";
  EXPECT_TRUE(same_path(D2, path({segment(Mode::D2, ExtentKind::target_eps_dev, 0.1)})));
  EXPECT_TRUE(same_path(D2, path({of(1, 0.1)}, 0.7004)));
  EXPECT_FALSE(same_path(D2, path({of(1, 0.1)}, 0.705)));
  EXPECT_FALSE(same_path(D2, path({of(1, 0.11)})));
  EXPECT_FALSE(same_path(D2, path({of(1, 0.1), segment(Mode::D2, ExtentKind::eps_dev, 0.1, true)})));
  EXPECT_FALSE(same_path(D2, path({segment(Mode::D3, ExtentKind::eps_dev, 0.1)})));
  PathSegment turning = of(1, 0.1);
  turning.spin << 0, 1, 0, -1, 0, 0, 0, 0, 0;
  EXPECT_FALSE(same_path(D2, path({turning})));
}

TEST(Path, NamesOfModesAndBranches) {
  EXPECT_EQ(to_string(Mode::ISO) + to_string(Mode::UNI) + to_string(Mode::D2) + to_string(Mode::D3), "ISOUNID2D3");
  EXPECT_EQ(to_string(Branch::loading), "loading");
  EXPECT_EQ(to_string(Branch::unloading), "unloading");
}

TEST(Path, IsOneForALawHoweverItsAxesAreTurned) {
  const auto turned = [](std::vector<StraightSegment> path, const Eigen::Matrix3d& Q) {
    for (StraightSegment& segment : path) {
      segment.direction.tensor = Q * segment.direction.tensor * Q.transpose();
      segment.spin = Q * segment.spin * Q.transpose();
    }
    return path;
  };
  const auto path = [](const std::vector<PathSegment>& segments) {
    return resolve(Path{0.70, Branch::unloading, segments});
  };
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(0, 0) = -1;
  std::vector<Eigen::Matrix3d> turns{mirror};
  for (const double angle : {0.3, 0.785398, 1.2, 2.9})
    turns.emplace_back(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, angle, -2).normalized()).toRotationMatrix());
  PathSegment spinning = segment(Mode::D2, ExtentKind::eps_dev, 0.1), sheared = spinning;
  spinning.spin << 0, 0.2, 0, -0.2, 0, 0.1, 0, -0.1, 0;
  sheared.mode = Mode::tensor;
  sheared.direction.tensor << 0, 0, 1, 0, 0, 0, 1, 0, 0;
  const std::vector<std::vector<StraightSegment>> paths{
      path({segment(Mode::D2, ExtentKind::eps_dev, 0.1)}),
      path({segment(Mode::D3, ExtentKind::eps_dev, 0.1)}),
      path({segment(Mode::ISO, ExtentKind::target_nu, 0.75)}),
      path({segment(Mode::D3, ExtentKind::eps_dev, 0.1), segment(Mode::D3, ExtentKind::eps_dev, 0.1, true)}),
      path({segment(Mode::D3, ExtentKind::eps_dev, 0.1), segment(Mode::D2, ExtentKind::eps_dev, 0.1)}),
      path({segment(Mode::D2, ExtentKind::eps_dev, 0.1), sheared}),
      path({spinning})};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (const Eigen::Matrix3d& Q : turns) {
      for (std::size_t j = 0; j < paths.size(); ++j)
        EXPECT_EQ(same_but_axes(paths[j], turned(paths[i], Q)), i == j) << i << " " << j;
    }
  }
  EXPECT_TRUE(same_but_axes(paths[0], path({sheared}))) << "D2 by another base";
}

}  // namespace
}  // namespace grainlaw
