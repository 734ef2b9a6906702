#include "dem/statics/packing_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace grainlaw::dem {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Spheres of radius 2 in a cubic cell of edge 20, each at a place (x, y, z): radii and places over <r> are half of that.
State spheres_at(const std::vector<Eigen::Vector3d>& places) {
  State state;
  state.packing.H = 20 * Eigen::Matrix3d::Identity();
  resize(state.packing, places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    state.packing.radius[i] = 2;
    state.packing.mass[i] = 1;
    state.packing.sx[i] = places[i].x() / 20;
    state.packing.sy[i] = places[i].y() / 20;
    state.packing.sz[i] = places[i].z() / 20;
  }
  return state;
}

/// A sphere at `from` and one whose overlap with it is `delta`, in direction `angle` of the plane x, z.
State pair(const Eigen::Vector3d& from, double angle, double delta) {
  return spheres_at({from, from + (4 - delta) * Eigen::Vector3d(std::cos(angle), 0, std::sin(angle))});
}

TEST(PackingPicture, OneContactInThePlane) {
  const PackingPicture picture = picture_of(pair({8, 10, 9}, 35 * kDegree, 0.1), 0, 2, 1);
  EXPECT_DOUBLE_EQ(picture.width, 10);
  EXPECT_DOUBLE_EQ(picture.height, 10);
  ASSERT_EQ(picture.circles.size(), 2u);
  EXPECT_NEAR(picture.circles[0][0], 4, 1e-12);
  EXPECT_NEAR(picture.circles[0][1], 4.5, 1e-12);
  EXPECT_NEAR(picture.circles[0][2], 1, 1e-12);
  ASSERT_EQ(picture.chains.size(), 1u);
  const auto& c = picture.chains[0];
  EXPECT_NEAR(std::hypot(c[2] - c[0], c[3] - c[1]), 1.95, 1e-12);
  EXPECT_NEAR(std::min(c[0], c[2]), 4, 1e-12);
  EXPECT_NEAR(std::max(c[1], c[3]), 4.5 + 1.95 * std::sin(35 * kDegree), 1e-12);
  EXPECT_DOUBLE_EQ(c[4], 1);
  ASSERT_EQ(picture.count.size(), static_cast<std::size_t>(kRoseBins));
  EXPECT_DOUBLE_EQ(picture.count[3], kRoseBins);  // 30 to 40 degrees
  EXPECT_DOUBLE_EQ(std::accumulate(picture.force.begin(), picture.force.end(), 0.0), kRoseBins);
}

TEST(PackingPicture, AnAngleIsThatOfALine) {
  for (const double degrees : {35, 215}) {
    EXPECT_DOUBLE_EQ(picture_of(pair({10, 10, 10}, degrees * kDegree, 0.1), 0, 2, 1).count[3], kRoseBins);
    EXPECT_DOUBLE_EQ(picture_of(pair({10, 10, 10}, degrees * kDegree, 0.1), 2, 0, 1).count[5], kRoseBins);
  }
}

TEST(PackingPicture, CutsAndContactsBesideThePlane) {
  const PackingPicture near = picture_of(pair({10, 10.9, 10}, 35 * kDegree, 0.1), 0, 2, 1);
  ASSERT_EQ(near.circles.size(), 2u);
  EXPECT_NEAR(near.circles[0][2], std::sqrt(1 - 0.45 * 0.45), 1e-12);
  EXPECT_EQ(near.chains.size(), 1u);
  const PackingPicture beside = picture_of(pair({10, 11.1, 10}, 35 * kDegree, 0.1), 0, 2, 1);
  EXPECT_EQ(beside.circles.size(), 2u);
  EXPECT_TRUE(beside.chains.empty());
  EXPECT_DOUBLE_EQ(beside.count[3], kRoseBins);  // of all contacts
  EXPECT_TRUE(picture_of(pair({10, 12.1, 10}, 35 * kDegree, 0.1), 0, 2, 1).circles.empty());
}

TEST(PackingPicture, ImagesAcrossTheEdge) {
  const PackingPicture picture = picture_of(pair({-1.5, 10, 10}, 0, 0.1), 0, 2, 1);  // from x = 18.5 to 2.4 of 20
  EXPECT_EQ(picture.circles.size(), 3u);
  EXPECT_EQ(picture.chains.size(), 2u);
}

TEST(PackingPicture, ForcesWeighTheRose) {
  State state = spheres_at({{4, 10, 4}, {7.9, 10, 4.1}, {14, 10, 14}, {14.1, 10, 17.7}});  // overlaps .1 and .3, nearly
  const PackingPicture picture = picture_of(state, 0, 2, 1);
  EXPECT_NEAR(picture.count[0] / picture.count[8], 1, 1e-12);
  const double first = 4 - std::hypot(3.9, 0.1), second = 4 - std::hypot(0.1, 3.7);
  EXPECT_NEAR(picture.force[8] / picture.force[0], second / first, 1e-9);
  EXPECT_TRUE(picture_of(spheres_at({{10, 10, 10}}), 0, 2, 1).count.empty());
}

}  // namespace
}  // namespace grainlaw::dem
