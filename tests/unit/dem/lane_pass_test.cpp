// Passes of the vector engine over one packing: both halves of a step at once, and rows that bypass the caches.
#include "dem/engine/lanes/lane_pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dem/engine/lanes/lane_list.hpp"
#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

/// Moving spheres, some of which overlap, with rows and near ones, about to end a step.
template <class Real>
struct Scene {
  ThreadTeam team{1};
  Lanes<Real> lanes;
  LaneStep step, next;
  std::size_t groups = 0;

  explicit Scene(std::size_t n) {
    scene::Draw draw(31);
    State state = scene::random_state(n, 3, 0.7, Eigen::Vector3d(1, 1.25, 0.75).asDiagonal(), draw);
    Packing& p = state.packing;
    round_radii(p);
    scene::random_velocities(p, 1e-3, draw);
    for (auto* a : {&state.ax, &state.ay, &state.az}) {
      for (std::size_t i = 0; i < n; ++i) a->push_back(draw.uniform(-1, 1));
    }
    state.ref_x = p.sx, state.ref_y = p.sy, state.ref_z = p.sz, state.ref_H = p.H;
    const double r = mean_radius(p), dt = 0.1 * min_collision_time(p, state.material);
    lanes = make_lanes<Real>(state, dt, 0.4 * r, 0.1 * r, team);
    groups = lanes.group.size();
    const Units& unit = lanes.unit;
    step.half_dt = dt / 2 / unit.time;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      step.edge[a] = p.H(axis, axis) / unit.length;
      step.drift[a] = 2 * step.half_dt / step.edge[a] * kQuantaPerEdge<Real>;
      step.rate[a] = (static_cast<double>(a) - 1) * 138 * unit.time;
    }
    step.stiffness = state.material.stiffness / (unit.mass / unit.time / unit.time);
    step.viscosity = state.material.contact_viscosity / (unit.mass / unit.time);
    step.drag = state.material.background_viscosity / (unit.mass / unit.time);
    step.allowed = 0.3 * r / unit.length;
    step.near_stretch = 1;
    for (SphereGroup<Real>& group : lanes.group) {
      std::fill(std::begin(group.near_skin), std::end(group.near_skin), static_cast<Real>(0.05 * r / unit.length));
    }
    next = step;
    next.half_dt *= 1.5;
    write_rows(lanes, step, 0, groups);
    pick_near(lanes, step.edge, 0, groups);
  }
};

template <class T, class Allocator>
bool same_bits(const std::vector<T, Allocator>& a, const std::vector<T, Allocator>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

template <class Real>
class LanePass : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LanePass, Precisions);

// With every target, rows written through the caches or past them.
TYPED_TEST(LanePass, BothHalvesAtOnceAreOneAfterTheOther) {
  const Scene<TypeParam> scene(300);
  ASSERT_NE(scene.lanes.spheres % kLanes, 0U) << "no unused lanes";
  for (const std::string& target : vector_targets()) {
    use_vector_target(target);
    Lanes<TypeParam> halves = scene.lanes;
    const LaneSums sums = force_and_kick(halves, scene.step, 0, scene.groups);
    const Drifted how = kick_and_drift(halves, scene.next, 0, scene.groups);
    EXPECT_FALSE(same_bits(halves.row, scene.lanes.row)) << target;
    EXPECT_GT(sums.contact_power, 0) << target << ": no contact";
    for (const bool past_caches : {false, true}) {
      Lanes<TypeParam> at_once = scene.lanes;
      at_once.beyond_caches = past_caches;
      Drifted same{};
      const LaneSums same_sums = force_kick_drift(at_once, scene.step, scene.next, 0, scene.groups, same);
      EXPECT_TRUE(same_bits(at_once.next_row, halves.row)) << target << (past_caches ? " past caches" : "");
      EXPECT_EQ(same, how) << target;
      EXPECT_EQ(same_sums.box_power, sums.box_power) << target;
      EXPECT_EQ(same_sums.contact_power, sums.contact_power) << target;
      EXPECT_EQ(same_sums.v2, sums.v2) << target;
      for (std::size_t g = 0; g < scene.groups; ++g) {
        EXPECT_EQ(std::memcmp(&at_once.group[g], &halves.group[g], sizeof halves.group[g]), 0)
            << target << ", group " << g;
      }
    }
  }
  use_vector_target("");
}

// Rows say again where spheres are, after which they are written anew without a change.
TYPED_TEST(LanePass, PlacesAreTakenFromRows) {
  Scene<TypeParam> scene(300);
  Lanes<TypeParam>& lanes = scene.lanes;
  const std::vector<PlacedGroup<TypeParam>> before = lanes.placed;
  Drifted how{};
  force_kick_drift(lanes, scene.step, scene.next, 0, scene.groups, how);
  std::swap(lanes.row, lanes.next_row);
  EXPECT_TRUE(same_bits(lanes.placed, before)) << "a pass over rows moved the placed groups";
  take_rows(lanes, 0, scene.groups);
  lanes.predicted = true;
  EXPECT_FALSE(same_bits(lanes.placed, before));
  for (std::size_t t = 0; t < lanes.spheres; ++t) {
    const PlacedGroup<TypeParam>& placed = lanes.placed[t / kLanes];
    const std::size_t l = t % kLanes;
    const SphereRow<TypeParam>& row = lanes.row[t];
    ASSERT_EQ(std::tie(placed.x[l], placed.y[l], placed.z[l], placed.radius[l]),
              std::tie(row.x, row.y, row.z, row.radius));
  }
  const Rows<TypeParam> rows = lanes.row;
  write_rows(lanes, scene.next, 0, scene.groups);
  EXPECT_TRUE(same_bits(lanes.row, rows));
}

}  // namespace
}  // namespace grainlaw::dem
