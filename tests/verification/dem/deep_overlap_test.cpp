// D17 and D18: spheres that lie inside each other or at one position.
//   a contact repels with k (r_i + r_j - |x_ij|) at any overlap, sum_i f_i = 0, and the energy that a pair holds,
//   k delta^2/2, comes back as work, motion or dissipation (D9); who starts a run from a pair that nothing holds together
//   is refused with both names, because no time step follows its parting well.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "dem/element_tests/element_run.hpp"
#include "dem/statics/relax.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using testing::expect_figure;

constexpr std::int64_t kBig = 404, kSmall = 717;

/// Sphere 0 is three times as large as the others; sphere 1 is put inside it, `depth` of its radius from its centre.
State small_inside_big(State state, double depth, Draw& draw) {
  Packing& p = state.packing;
  p.id[0] = kBig;
  p.id[1] = kSmall;
  const Eigen::Vector3d away = depth * p.radius[0] * draw.vector(-1, 1).normalized();
  scene::place(p, 1, scene::fraction(p, 0) + p.H.inverse() * away);
  return state;
}

std::vector<State> packings_with_a_big_sphere() {
  Draw draw(71);
  return {scene::state_of(scene::cubic(20e-3), {{3e-3, {10e-3, 10e-3, 10e-3}}, {1e-3, {10e-3, 10e-3, 10e-3}}}),
          scene::state_of_family({"Intruder", 1, 3}, 60, 0.5, draw), scene::jammed({"Intruder", 1, 3}, 60, 0.75, 5)};
}

/// Message of the error that `action` ends in, of whichever kind; empty when it does not.
template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

bool names_both(const std::string& message) {
  return message.find(std::to_string(kBig)) != std::string::npos &&
         message.find(std::to_string(kSmall)) != std::string::npos;
}

std::vector<StraightSegment> compression(const State& state) {
  return {scene::segment_of(Eigen::Vector3d(0, 0, -1).asDiagonal(), 0.01, volume_fraction(state.packing))};
}

TEST(DeepOverlap, D17Repels) {
  Draw draw(73);
  double force_error = 0, total = 0;
  for (const State& state : packings_with_a_big_sphere()) {
    for (const double depth : {0.01, 0.1, 0.5, 0.9, 1.2}) {
      const State deep = small_inside_big(state, depth, draw);
      const ReferenceSums sums = reference_sums(deep.packing, deep.material, scene::at_rest(deep));
      Simulation sim = scene::start(deep);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < deep.packing.size(); ++i) {
        force_error = std::max(force_error, (scene::force_on(sim, i) - sums.force[i]).norm() / sums.max_force);
        sum += scene::force_on(sim, i);
      }
      total = std::max(total, sum.norm() / sums.max_force);
      // the pair's own contact, alone
      const Eigen::Vector3d x_ij = scene::position(deep.packing, 1) - scene::position(deep.packing, 0);
      const State pair = scene::state_of(deep.packing.H, {{deep.packing.radius[1], x_ij}, {deep.packing.radius[0]}});
      const double delta = pair.packing.radius[0] + pair.packing.radius[1] - x_ij.norm();
      const Eigen::Vector3d expected = pair.material.stiffness * delta * x_ij.normalized();
      EXPECT_LE((scene::force_on(scene::start(pair), 0) - expected).norm(), 1e-12 * expected.norm());
    }
  }
  expect_figure("D17.force_error", force_error, 1e-12);
  expect_figure("D17.sum_of_forces", total, 1e-12);
}

TEST(DeepOverlap, D17ElementTestsRefuseAPairThatNothingHolds) {
  Draw draw(79);
  int neither = 0, refused = 0;
  double balance = 0;
  for (const State& state : packings_with_a_big_sphere()) {
    for (const double depth : {1e-9, 1e-3, 0.1, 0.5, 0.9, 0.99}) {
      for (const double fraction : {0.02, 0.1}) {
        const State deep = small_inside_big(state, depth, draw);
        ElementTestOptions options;
        options.engine = scene::engine_options();
        options.engine.time_step_fraction = fraction;
        options.drive.strain_rate = 3000;
        double residual = 0;
        const std::string message = error_of([&] {
          for (const Observation& row : run_element_test(deep, compression(deep), options, {}).rows) {
            residual = std::max(residual, std::abs(row.energy_residual));
          }
        });
        if (names_both(message)) {
          ++refused;
        } else {
          neither += message.empty() && residual <= 1e-3 ? 0 : 1;
          balance = std::max(balance, residual);
        }
      }
    }
  }
  EXPECT_GT(refused, 0);
  expect_figure("D17.neither_refused_nor_balanced", neither, 0);
  expect_figure("D17.balance", balance, 1e-3);
}

// Caught between a big one and its image the small sphere is in equilibrium: such packings run.
TEST(DeepOverlap, D17ElementTestsAcceptAPairThatIsHeld) {
  const double r = 3e-3, edge = 2 * r * 0.98;
  const State held =
      scene::state_of(Eigen::Vector3d(edge, 20e-3, 20e-3).asDiagonal(),
                      {{r, {0, 10e-3, 10e-3}}, {0.05e-3, {edge / 2, 10e-3, 10e-3}}}, {2000, 1e8, 0.01, 0.1});
  ElementTestOptions options;
  options.engine = scene::engine_options();
  options.engine.time_step_fraction = 0.02;
  options.drive.strain_rate = 3000;
  EXPECT_EQ(error_of([&] { run_element_test(held, compression(held), options, {}); }), "");
}

TEST(DeepOverlap, D17RelaxationParts) {
  Draw draw(83);
  for (const State& state : packings_with_a_big_sphere()) {
    State deep = small_inside_big(state, 0.1, draw);
    EXPECT_TRUE(relax(deep, {}, {}, {}).relaxed);
    const double distance = (scene::position(deep.packing, 0) - scene::position(deep.packing, 1)).norm();
    EXPECT_GT(distance, 0.9 * (deep.packing.radius[0] + deep.packing.radius[1]));
  }
}

/// Spheres 0 and 1 at exactly `distance` from each other along one axis.
State at_distance(double distance, int axis) {
  State state = scene::state_of(scene::cubic(20e-3), {{1e-3}, {1e-3}, {1e-3, {1.5e-3, 9e-3, 9e-3}}});
  state.packing.id = {kBig, kSmall, 5};
  Eigen::Vector3d s = Eigen::Vector3d::Zero();
  s(axis) = distance / 20e-3;
  scene::place(state.packing, 1, s);
  return state;
}

TEST(DeepOverlap, D18CoincidingSpheresAreNamed) {
  int not_named = 0;
  for (const double distance : {0.0, 1e-300, 1e-200, 1e-162}) {
    for (int axis = 0; axis < 3; ++axis) {
      const State state = at_distance(distance, axis);
      not_named += names_both(error_of([&] { scene::start(state); })) ? 0 : 1;
      not_named += names_both(error_of([&] { run_element_test(state, compression(state), {}, {}); })) ? 0 : 1;
      not_named += names_both(error_of([&] {
        State copy = state;
        relax(copy, {}, {}, {});
      }))
                       ? 0
                       : 1;
    }
  }
  expect_figure("D18.not_named", not_named, 0);
}

// From where the square of the distance is a number on, the direction is right.
TEST(DeepOverlap, D18TinyDistancesHaveADirection) {
  double error = 0;
  for (const double distance : {1e-150, 1e-100, 1e-20, 1e-9}) {
    for (int axis = 0; axis < 3; ++axis) {
      const State state = at_distance(distance, axis);
      Simulation sim = scene::start(state);
      Eigen::Vector3d expected = Eigen::Vector3d::Zero();
      expected(axis) = state.material.stiffness * (2e-3 - distance);
      error = std::max(error, (scene::force_on(sim, 1) - expected).norm() / expected.norm());
      scene::advance_at_rest(sim, 10);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(scene::position(sim.state().packing, i).allFinite() &&
                    scene::velocity(sim.state().packing, i).allFinite());
      }
      EXPECT_GT(sim.state().packing.size() > 1 ? scene::velocity(sim.state().packing, 1)(axis) : 0, 0);
    }
  }
  expect_figure("D18.direction_error", error, 1e-12);
}

}  // namespace
}  // namespace grainlaw::dem
