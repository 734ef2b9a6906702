// Lists of lanes against brute force (hard case D19 for the vector engine), and a state's way through lanes and back.
#include "dem/engine/lanes/lane_list.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "dem/engine/neighbour_list.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/dem_state_bits.hpp"

namespace grainlaw::dem {
namespace {

using ListedPair = std::tuple<std::size_t, std::size_t, int, int, int>;  // i, j, image

/// A random packing of float radii in a rectangular cell, moving, with accelerations and the reference of a list.
State random_box(std::size_t n, double w, const Eigen::Vector3d& shape, scene::Draw& draw) {
  State state = scene::random_state(n, w, 0.7, shape.asDiagonal(), draw);
  Packing& p = state.packing;
  round_radii(p);
  scene::random_velocities(p, 1, draw);
  for (auto* a : {&state.ax, &state.ay, &state.az}) {
    for (std::size_t i = 0; i < n; ++i) a->push_back(draw.uniform(-1e6, 1e6));
  }
  state.ref_x = p.sx, state.ref_y = p.sy, state.ref_z = p.sz, state.ref_H = p.H;
  return state;
}

std::set<ListedPair> pairs_of(const NeighbourList& list) {
  std::set<ListedPair> pairs;
  for (std::size_t i = 0; i + 1 < list.first.size(); ++i) {
    for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
      const Eigen::Vector3i n = list.offset[list.image[c]].cast<int>();
      EXPECT_TRUE(pairs.emplace(i, list.j[c], n[0], n[1], n[2]).second)
          << "listed twice: " << i << " " << list.j[c] << " image " << n.transpose();
    }
  }
  return pairs;
}

/// Every pair nearer than r_i + r_j + reach, from both sides.
std::set<ListedPair> brute_force(const Packing& p, double reach) {
  std::set<ListedPair> pairs;
  for (const ReferencePair& pair : reference_pairs(p, reach)) {
    const Eigen::Vector3i n = pair.image;
    pairs.emplace(pair.i, pair.j, n[0], n[1], n[2]);
    pairs.emplace(pair.j, pair.i, -n[0], -n[1], -n[2]);
  }
  return pairs;
}

template <class Real>
class LaneList : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LaneList, Precisions);

// All within the skin, nobody from beyond what the search's rounding allows, for any number of lanes in use.
TYPED_TEST(LaneList, D19EqualsBruteForce) {
  scene::Draw draw(19);
  ThreadTeam team(2);
  int lists = 0;
  for (const double w : {1.0, 3.0, 10.0}) {
    for (const Eigen::Vector3d& shape :
         {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 1, 1)}) {
      for (const std::size_t n : {150U, 333U, 512U}) {
        const State state = random_box(n, w, shape, draw);
        const double r_max = *std::max_element(state.packing.radius.begin(), state.packing.radius.end());
        const double skin = draw.uniform(0.1, 0.8) * mean_radius(state.packing);
        const Eigen::Vector3d edge = state.packing.H.diagonal();
        if (!fits_lanes({edge[0], edge[1], edge[2]}, 2 * r_max + skin)) continue;
        const std::set<ListedPair> listed = pairs_of(
            plain_list(make_lanes<TypeParam>(state, 1e-8, skin, 0.1 * skin, team), state.packing, Listed::all));
        const std::set<ListedPair> within = brute_force(state.packing, skin * (1 - 1e-9)),
                                   around = brute_force(state.packing, skin + 1e-5 * 2 * r_max);
        EXPECT_TRUE(std::includes(listed.begin(), listed.end(), within.begin(), within.end())) << "missed";
        EXPECT_TRUE(std::includes(around.begin(), around.end(), listed.begin(), listed.end())) << "invented";
        ++lists;
      }
    }
  }
  EXPECT_GE(lists, 10);
}

// Layers of so many spheres that the cell is cut into stripes: the pairs are those of the plain list.
TYPED_TEST(LaneList, D19StripesOfAFlatCell) {
  scene::Draw draw(24);
  ThreadTeam team(2);
  const State state = random_box(30000, 1, {32, 32, 1}, draw);
  const double skin = 0.2 * mean_radius(state.packing), close = 1e-5 * mean_radius(state.packing);
  const auto pairs_within = [&](double reach) { return pairs_of(build_list(state.packing, reach, team)); };
  const std::set<ListedPair> listed =
      pairs_of(plain_list(make_lanes<TypeParam>(state, 1e-8, skin, 0.1 * skin, team), state.packing, Listed::all));
  const std::set<ListedPair> within = pairs_within(skin - close), around = pairs_within(skin + close);
  EXPECT_GT(within.size(), 30000U);
  EXPECT_TRUE(std::includes(listed.begin(), listed.end(), within.begin(), within.end())) << "missed";
  EXPECT_TRUE(std::includes(around.begin(), around.end(), listed.begin(), listed.end())) << "invented";
}

/// Near skins between 0 and `most` [m].
template <class Real>
void draw_near_skins(Lanes<Real>& lanes, double most, scene::Draw& draw) {
  for (SphereGroup<Real>& group : lanes.group) {
    for (Real& skin : group.near_skin) skin = static_cast<Real>(draw.uniform(0, most / lanes.unit.length));
  }
}

// The near ones are those of the list within the two spheres' near skins.
TYPED_TEST(LaneList, D19NearOnesAreAllThatAreNear) {
  scene::Draw draw(20);
  ThreadTeam team(1);
  const State state = random_box(700, 3, {1, 1.5, 1}, draw);
  const double r = mean_radius(state.packing), close = 1e-5 * r;
  Lanes<TypeParam> lanes = make_lanes<TypeParam>(state, 1e-8, 0.6 * r, 0.1 * r, team);
  draw_near_skins(lanes, 0.3 * r, draw);
  const double length = lanes.unit.length;
  const Eigen::Vector3d edge = state.packing.H.diagonal() / length;
  LaneStep step;
  write_rows(lanes, step, 0, lanes.group.size());
  pick_near(lanes, {edge[0], edge[1], edge[2]}, 0, lanes.group.size());
  const std::set<ListedPair> all = pairs_of(plain_list(lanes, state.packing, Listed::all)),
                             near = pairs_of(plain_list(lanes, state.packing, Listed::near));
  Packing widened = state.packing;
  for (std::size_t t = 0; t < lanes.spheres; ++t) {
    widened.radius[lanes.listed[t / kLanes].sphere[t % kLanes]] +=
        static_cast<double>(lanes.group[t / kLanes].near_skin[t % kLanes]) * length;
  }
  const std::set<ListedPair> within = brute_force(widened, -close), around = brute_force(widened, close);
  EXPECT_TRUE(std::includes(near.begin(), near.end(), within.begin(), within.end())) << "missed";
  EXPECT_TRUE(std::includes(around.begin(), around.end(), near.begin(), near.end())) << "invented";
  EXPECT_LT(near.size(), all.size());
}

// As wide as a sphere's speed asks for, within what the list knows; by plain formulas, on all vectors.
TYPED_TEST(LaneList, NearSkinsFollowSpeeds) {
  scene::Draw draw(25);
  ThreadTeam team(1);
  const State state = random_box(333, 3, {1, 1.5, 1}, draw);
  const double r = mean_radius(state.packing);
  for (const std::string& target : vector_targets()) {
    use_vector_target(target);
    Lanes<TypeParam> lanes = make_lanes<TypeParam>(state, 1e-8, 0.6 * r, 0.1 * r, team);
    const double length = lanes.unit.length, r_0 = r / length;
    const Eigen::Vector3d edge = state.packing.H.diagonal() / length;
    // each axis moved by up to .1 mean radii since the near ones were picked and since the list was made
    using Int = FixedPoint<TypeParam>;
    const auto up_to = [&](double radii) {
      return static_cast<Int>(draw.uniform(-radii, radii) * r_0 / edge.maxCoeff() * kStepsPerEdge<TypeParam>);
    };
    using Unsigned = std::make_unsigned_t<Int>;  // positions wrap around
    const auto plus = [](Int a, Int b) {
      return static_cast<Int>(static_cast<Unsigned>(a) + static_cast<Unsigned>(b));
    };
    const auto minus = [](Int a, Int b) {
      return static_cast<Int>(static_cast<Unsigned>(a) - static_cast<Unsigned>(b));
    };
    double fastest = 0;
    for (std::size_t g = 0; g < lanes.group.size(); ++g) {
      SphereGroup<TypeParam>& group = lanes.group[g];
      const PlacedGroup<TypeParam>& placed = lanes.placed[g];
      for (std::size_t l = 0; l < kLanes; ++l) {
        group.near_x[l] = plus(placed.x[l], up_to(0.1)), group.near_y[l] = plus(placed.y[l], up_to(0.1)),
        group.near_z[l] = plus(placed.z[l], up_to(0.1));
        lanes.listed[g].x[l] = plus(lanes.listed[g].x[l], up_to(0.1)),
        lanes.listed[g].y[l] = plus(lanes.listed[g].y[l], up_to(0.1)),
        lanes.listed[g].z[l] = plus(lanes.listed[g].z[l], up_to(0.1));
        fastest = std::max(fastest, Eigen::Vector3d(group.vx[l], group.vy[l], group.vz[l]).norm());
      }
    }
    draw_near_skins(lanes, 0.5 * r, draw);
    const Lanes<TypeParam> before = lanes;
    const auto moved = [&](Int x, Int y, Int z, Int x_0, Int y_0, Int z_0) {
      const auto part = [&](Int a, Int b) { return static_cast<double>(minus(a, b)) / kStepsPerEdge<TypeParam>; };
      return Eigen::Vector3d(part(x, x_0) * edge[0], part(y, y_0) * edge[1], part(z, z_0) * edge[2]).norm();
    };
    const double duration = 0.2 * r_0 / fastest;
    const NearSkins skins{duration, duration / 4, 0.5, 0.15 * r_0, 0.25 * r_0, 0.32 * r_0};
    const double reach = choose_near_skins(lanes, {edge[0], edge[1], edge[2]}, skins, 0, lanes.group.size());
    double farthest = 0;
    int least = 0, most = 0, free = 0, held = 0;
    for (std::size_t t = 0; t < lanes.spheres; ++t) {
      const std::size_t l = t % kLanes;
      const SphereGroup<TypeParam>&g = before.group[t / kLanes], &now = lanes.group[t / kLanes];
      const PlacedGroup<TypeParam>& placed = before.placed[t / kLanes];
      const ListedGroup<TypeParam>& listed = before.listed[t / kLanes];
      const double v = Eigen::Vector3d(g.vx[l], g.vy[l], g.vz[l]).norm(),
                   near = moved(placed.x[l], placed.y[l], placed.z[l], g.near_x[l], g.near_y[l], g.near_z[l]),
                   in_all = moved(placed.x[l], placed.y[l], placed.z[l], listed.x[l], listed.y[l], listed.z[l]);
      const double wanted = std::max({skins.duration * v, skins.duration / skins.since * near,
                                      skins.memory * static_cast<double>(g.near_skin[l]), skins.least});
      const double expected = std::max(0.0, std::min({wanted, skins.most, skins.listed - in_all}));
      ASSERT_NEAR(static_cast<double>(now.near_skin[l]), expected, 1e-5 * r_0);
      ASSERT_NEAR(static_cast<double>(lanes.row[t].reach), static_cast<double>(placed.radius[l] + now.near_skin[l]),
                  1e-6 * r_0);
      farthest = std::max(farthest, in_all + static_cast<double>(now.near_skin[l]));
      ++(expected == skins.least ? least : expected == skins.most ? most : expected < wanted ? held : free);
    }
    EXPECT_NEAR(reach, farthest, 1e-5 * r_0);
    fmt::print("{}: {} least, {} most, {} held back by the list, {} as wanted\n", target, least, most, held, free);
    EXPECT_GT(least, 0);
    EXPECT_GT(most, 0);
    EXPECT_GT(held, 0);
    EXPECT_GT(free, 0);
  }
  use_vector_target("");
}

// Whatever the number, also none, and on all vectors.
TEST(LaneSearch, OrdersByKeyWithEveryTarget) {
  scene::Draw draw(23);
  for (const std::string& target : vector_targets()) {
    use_vector_target(target);
    for (std::size_t count = 0; count <= 50; ++count) {
      std::vector<std::int32_t> key(count + kLanes);
      std::vector<std::uint32_t> value(count), ordered(count + 1, 7);
      for (std::size_t k = 0; k < count; ++k) {
        key[k] = static_cast<std::int32_t>(100 * k + static_cast<std::size_t>(draw.uniform(0, 99)));
        std::swap(key[k], key[static_cast<std::size_t>(draw.uniform(0, static_cast<double>(k + 1)))]);
      }
      for (std::size_t k = 0; k < count; ++k)
        value[k] = static_cast<std::uint32_t>(key[k] / 100);  // 0, 1 ... in the wanted order
      order_by_key(key.data(), value.data(), count, ordered.data());
      for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(ordered[k], k) << target << ", of " << count;
      EXPECT_EQ(ordered[count], 7U) << "written beyond the end";
    }
  }
  use_vector_target("");
}

// What lanes have stored is theirs again, bit for bit.
TYPED_TEST(LaneList, AStateGoesThroughLanesUnchanged) {
  scene::Draw draw(21);
  ThreadTeam team(1);
  State once = random_box(100, 3, {1, 1, 1}, draw);
  const double r = mean_radius(once.packing);
  store_lanes(make_lanes<TypeParam>(once, 1e-8, 0.3 * r, 0.05 * r, team), once);
  State twice = once;
  store_lanes(make_lanes<TypeParam>(twice, 1e-8, 0.3 * r, 0.05 * r, team), twice);
  EXPECT_EQ(scene::bits_of(twice), scene::bits_of(once));
}

// A sphere that has left the cell since the list was made is given where it is, not wrapped: exactly, as dyadic moves are
// on the grid of both precisions.
TYPED_TEST(LaneList, APositionBeyondTheCellIsNotWrapped) {
  scene::Draw draw(22);
  ThreadTeam team(1);
  State state = random_box(100, 3, {1, 1, 1}, draw);
  const double r = mean_radius(state.packing);
  const auto through_lanes = [&] { store_lanes(make_lanes<TypeParam>(state, 1e-8, 0.3 * r, 0.05 * r, team), state); };
  through_lanes();
  Packing& p = state.packing;
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.sx[i] = state.ref_x[i] - 0.25;
    p.sy[i] = state.ref_y[i] + 0.375;
    p.sz[i] = state.ref_z[i] - 0.4375;
  }
  const Packing moved = p;
  EXPECT_LT(*std::min_element(moved.sx.begin(), moved.sx.end()), 0);
  EXPECT_GT(*std::max_element(moved.sy.begin(), moved.sy.end()), 1);
  through_lanes();
  EXPECT_EQ(p.sx, moved.sx);
  EXPECT_EQ(p.sy, moved.sy);
  EXPECT_EQ(p.sz, moved.sz);
}

TEST(FitsLanes, OneImageOnly) {
  EXPECT_TRUE(fits_lanes({10, 11, 12}, 4.999));
  EXPECT_FALSE(fits_lanes({10, 11, 12}, 5));
  EXPECT_FALSE(fits_lanes({12, 11, 9.9}, 4.999));
}

}  // namespace
}  // namespace grainlaw::dem
