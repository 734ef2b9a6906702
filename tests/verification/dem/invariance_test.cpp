// What must not matter: a uniform velocity (Galilei), the order of the spheres' names, the names of the axes, a restart from a
// copied state (same bits), the skin of the list. The number of threads is in threads_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "dem/engine/averages.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_families.hpp"
#include "tests/support/dem_state_bits.hpp"

namespace grainlaw::dem {
namespace {

using scene::bits_of;
using scene::Draw;

constexpr double kSpeed = 2;  // m/s

/// A shaken, jammed packing: its motion does not amplify rounding much within some hundred steps.
State shaken_packing(const Material& material = {}) {
  Draw draw(61);
  State state = scene::random_state(300, 3, 0.7, Eigen::Matrix3d::Identity(), draw, material);
  relax(state, EngineOptions{}, RelaxOptions{}, RunControl{});
  scene::random_velocities(state.packing, kSpeed, draw);
  return state;
}

Drive uniaxial(const State& state, int axis = 2) {
  const Eigen::Vector3d direction = -Eigen::Vector3d::Unit(axis);
  DriveOptions options;
  options.strain_rate = 2e4;
  options.profile = Profile::constant;
  return make_drive(scene::segment_of(direction.asDiagonal(), 0.05, 0.7), options, state.packing.H);
}

void advance_along(Simulation& sim, const Drive& drive, int from, int to) {
  for (int k = from; k < to; ++k)
    scene::step(sim, motion_at(drive, (k + 0.5) * sim.dt()), motion_at(drive, (k + 1) * sim.dt()));
}

TEST(Invariance, SameBitsWhenContinuedFromACopy) {
  const State state = scene::bursting_packing(600);
  const Drive drive = uniaxial(state);
  Simulation whole = scene::start(state, 0.1);
  whole.open_ledger();
  std::uint64_t rebuilds = 0;
  int at_a_rebuild = 0;
  for (int k = 0; k < 120; ++k) {
    advance_along(whole, drive, k, k + 1);
    if (whole.rebuilds() != rebuilds) ++at_a_rebuild;
    rebuilds = whole.rebuilds();
    // Continue a copy for some steps, with another number of threads.
    EngineOptions options = whole.options();
    options.threads = 1 + k % 3;
    Simulation copy(whole.state(), options, motion_at(drive, (k + 1) * whole.dt()));
    ASSERT_EQ(copy.dt(), whole.dt());
    Simulation original = whole;
    advance_along(copy, drive, k + 1, k + 4);
    advance_along(original, drive, k + 1, k + 4);
    ASSERT_TRUE(bits_of(copy.state()) == bits_of(original.state())) << "continued at step " << k;
  }
  EXPECT_GT(at_a_rebuild, 1);
}

TEST(Invariance, Galilean) {
  const State resting = shaken_packing({2000, 1e8, 1, 0});  // without drag, which knows a frame of rest
  State moving = resting;
  const Eigen::Vector3d boost(37, -21, 53);
  for (std::size_t i = 0; i < moving.packing.size(); ++i) {
    scene::launch(moving.packing, i, scene::velocity(resting.packing, i) + boost);
  }
  Simulation a = scene::start(resting, 0.1), b = scene::start(moving, 0.1);
  a.open_ledger();
  b.open_ledger();
  const int steps = 200;
  scene::advance_at_rest(a, steps);
  scene::advance_at_rest(b, steps);
  double worst = 0;
  for (std::size_t i = 0; i < resting.packing.size(); ++i) {
    const Eigen::Vector3d v = scene::velocity(a.state().packing, i);
    worst = std::max(worst, (scene::velocity(b.state().packing, i) - boost - v).norm());
  }
  EXPECT_LE(worst, 1e-9 * kSpeed) << "rounding, amplified by some collisions";
  EXPECT_NEAR(a.state().sums.E_pot, b.state().sums.E_pot, 1e-10 * a.state().sums.E_pot);
  EXPECT_NEAR(a.state().ledger.D_contact, b.state().ledger.D_contact, 1e-10 * a.state().ledger.D_contact);
}

TEST(Invariance, OrderOfTheSpheres) {
  const State given = shaken_packing();
  State shuffled = given;
  const std::size_t n = given.packing.size();
  Draw draw(67);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[draw.index(i)]);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = order[i];
    shuffled.packing.id[i] = given.packing.id[j];
    shuffled.packing.radius[i] = given.packing.radius[j];
    shuffled.packing.mass[i] = given.packing.mass[j];
    scene::place(shuffled.packing, i, scene::fraction(given.packing, j));
    scene::launch(shuffled.packing, i, scene::velocity(given.packing, j));
  }
  Simulation a = scene::start(given, 0.1), b = scene::start(shuffled, 0.1);
  scene::advance_at_rest(a, 100);
  scene::advance_at_rest(b, 100);
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    worst =
        std::max(worst, (scene::velocity(b.state().packing, i) - scene::velocity(a.state().packing, order[i])).norm());
  }
  EXPECT_LE(worst, 1e-9 * kSpeed);
}

TEST(Invariance, NamesOfTheAxes) {
  const State given = shaken_packing();
  for (const int turn : {1, 2}) {
    const auto turned = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v[(3 - turn) % 3], v[(4 - turn) % 3], v[(5 - turn) % 3]);
    };
    State state = given;
    for (std::size_t i = 0; i < given.packing.size(); ++i) {
      scene::place(state.packing, i, turned(scene::fraction(given.packing, i)));
      scene::launch(state.packing, i, turned(scene::velocity(given.packing, i)));
    }
    Simulation a = scene::start(given, 0.1), b = scene::start(state, 0.1);
    advance_along(a, uniaxial(given, 2), 0, 100);
    advance_along(b, uniaxial(state, (2 + turn) % 3), 0, 100);
    double worst = 0;
    for (std::size_t i = 0; i < given.packing.size(); ++i) {
      const Eigen::Vector3d v = turned(scene::velocity(a.state().packing, i));
      worst = std::max(worst, (scene::velocity(b.state().packing, i) - v).norm());
    }
    EXPECT_LE(worst, 1e-9 * kSpeed) << "x is called "
                                    << "xyz"[turn];
  }
}

TEST(Invariance, SkinOfTheList) {
  const State state = shaken_packing();
  std::vector<Observation> seen;
  for (const double skin : {0.02, 0.1, 1.0}) {
    EngineOptions options = scene::engine_options();
    options.skin = skin;
    Simulation sim(state, options, scene::at_rest(state));
    scene::advance_at_rest(sim, 100);
    seen.push_back(observe(sim, scene::at_rest(state), Deviator<double>::Zero()));
  }
  for (const Observation& other : seen) {
    EXPECT_NEAR(other.E_pot, seen[0].E_pot, 1e-9 * seen[0].E_pot);
    EXPECT_LE((other.stress.tensor - seen[0].stress.tensor).norm(), 1e-9 * seen[0].stress.tensor.norm());
    EXPECT_EQ(other.C_r, seen[0].C_r);
  }
}

}  // namespace
}  // namespace grainlaw::dem
