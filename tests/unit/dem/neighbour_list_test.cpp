#include "dem/engine/neighbour_list.hpp"

#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/dem_pair_list.hpp"

namespace grainlaw::dem {
namespace {

using Entry = std::tuple<std::uint32_t, double, double, double>;  // neighbour and image offset

std::vector<Entry> entries(const NeighbourList& list, std::size_t i) {
  std::vector<Entry> found;
  for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
    const Eigen::Vector3d& n = list.offset[list.image[c]];
    found.emplace_back(list.j[c], n.x(), n.y(), n.z());
  }
  return found;
}

TEST(NeighbourList, PairAcrossTheFace) {
  // x_ij = H (s_i - s_j - n): sphere 0 at 0.5 mm meets sphere 1 at 19 mm through n = -1.
  const State state = scene::state_of(scene::cubic(20e-3), {{1e-3, {0.5e-3, 5e-3, 5e-3}}, {1e-3, {19e-3, 5e-3, 5e-3}}});
  ThreadTeam team(1);
  const NeighbourList list = build_list(state.packing, 0.1e-3, team);
  EXPECT_EQ(entries(list, 0), (std::vector<Entry>{{1, -1, 0, 0}}));
  EXPECT_EQ(entries(list, 1), (std::vector<Entry>{{0, 1, 0, 0}}));
  EXPECT_EQ(list.r_max, 1e-3);
  EXPECT_EQ(list.skin, 0.1e-3);
}

TEST(NeighbourList, SkinDecidesWhoIsListed) {
  const State state =
      scene::state_of(scene::cubic(20e-3), {{1e-3, {5e-3, 5e-3, 5e-3}}, {1.5e-3, {7.8e-3, 5e-3, 5e-3}}});
  ThreadTeam team(1);
  EXPECT_EQ(build_list(state.packing, 0.29e-3, team).j.size(), 0U);
  EXPECT_EQ(build_list(state.packing, 0.31e-3, team).j.size(), 2U);
}

TEST(NeighbourList, OneSphereAndItsOwnImages) {
  // Cell edge 2.1 mm, reach 2.2 mm: six images, each once; the sphere itself is none.
  const State state = scene::state_of(scene::cubic(2.1e-3), {{1e-3, {1e-3, 1e-3, 1e-3}}});
  ThreadTeam team(1);
  const NeighbourList list = build_list(state.packing, 0.2e-3, team);
  EXPECT_EQ(
      entries(list, 0),
      (std::vector<Entry>{{0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, -1}, {0, 0, 0, 1}, {0, 0, 1, 0}, {0, 1, 0, 0}}));
}

TEST(NeighbourList, SortedByNeighbourThenImage) {
  scene::Draw draw(3);
  const State state = scene::random_state(60, 3, 0.9, scene::random_shape(4, 0.6, draw), draw);
  ThreadTeam team(1);
  const NeighbourList list = build_list(state.packing, 0.3e-3, team);
  for (std::size_t i = 0; i < 60; ++i) {
    const std::vector<Entry> found = entries(list, i);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end())) << "sphere " << i;
  }
}

TEST(NeighbourList, DoesNotDependOnThreads) {
  scene::Draw draw(5);
  const State state = scene::random_state(700, 3, 0.7, Eigen::Matrix3d::Identity(), draw);
  ThreadTeam one(1), four(4);
  const NeighbourList a = build_list(state.packing, 0.1e-3, one), b = build_list(state.packing, 0.1e-3, four);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.j, b.j);
  EXPECT_EQ(a.image, b.image);
}

TEST(NeighbourList, EmptyPacking) {
  ThreadTeam team(1);
  const NeighbourList list = build_list(Packing{}, 0.1e-3, team);
  EXPECT_EQ(list.first, std::vector<std::size_t>{0});
  EXPECT_TRUE(list.j.empty());
}

TEST(NeighbourList, WrapPutsFractionsIntoTheCell) {
  Packing p;
  resize(p, 5);
  p.sx = {-0.25, 1.0, 2.75, -1e-18, 0.5};  // just below 0: the next double below 1 is the nearest inside
  wrap(p);
  EXPECT_EQ(p.sx[0], 0.75);
  EXPECT_EQ(p.sx[1], 0);
  EXPECT_EQ(p.sx[2], 0.75);
  EXPECT_EQ(p.sx[4], 0.5);
  for (const double s : p.sx) {
    EXPECT_GE(s, 0);
    EXPECT_LT(s, 1);
  }
}

TEST(AllowedDisplacement, HalfTheSkinAtFixedCell) {
  NeighbourList list;
  list.skin = 0.2e-3;
  list.r_max = 1.5e-3;
  const Eigen::Matrix3d H = 1e-2 * Eigen::Matrix3d::Identity();
  EXPECT_NEAR(allowed_displacement(list, H, H), 0.1e-3, 1e-17);
}

TEST(AllowedDisplacement, FallsWithTheSmallestStretch) {
  // min(1, sigma_min) (2 r_max + skin) - 2 u = 2 r_max; equality where the stretch decides, a lower bound elsewhere.
  NeighbourList list;
  list.skin = 0.2e-3;
  list.r_max = 1.5e-3;
  const Eigen::Matrix3d H = 1e-2 * Eigen::Matrix3d::Identity();
  const auto exact = [&](double sigma) { return (sigma * 3.2e-3 - 3e-3) / 2; };
  const Eigen::Matrix3d squeezed = Eigen::Vector3d(1, 0.95, 1.2).asDiagonal() * H;
  EXPECT_NEAR(allowed_displacement(list, H, squeezed), exact(0.95), 1e-17);
  const Eigen::Matrix3d crushed = Eigen::Vector3d(1, 0.8, 1).asDiagonal() * H;
  EXPECT_LT(allowed_displacement(list, H, crushed), 0) << "the deformation alone invalidates the list";
  EXPECT_LE(allowed_displacement(list, H, Eigen::Matrix3d(1.5 * H)), exact(1))
      << "growth gives no room to small spheres";
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  const double g = 0.05;
  F(0, 2) = g;  // simple shear: sigma_min = sqrt(1 + g^2/4) - g/2
  const double allowed = allowed_displacement(list, H, F * H);
  EXPECT_LE(allowed, exact(std::sqrt(1 + g * g / 4) - g / 2) + 1e-17);
  EXPECT_GT(allowed, exact(1 - 1.1 * g));
}

}  // namespace
}  // namespace grainlaw::dem
