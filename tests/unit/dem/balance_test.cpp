#include "dem/statics/balance.hpp"

#include <gtest/gtest.h>

#include "dem/statics/contact_network.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

State hundred_at_rest(double nu, std::uint64_t seed) {
  scene::Draw draw(seed);
  State state = scene::random_state(100, 3, nu, scene::cubic(1), draw);
  EXPECT_TRUE(relax(state, {}, {}, {}).relaxed);
  return backbone_of(state, 1);
}

double residual(const State& state) {
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  double largest = 0, contacts = 0;
  for (const Eigen::Vector3d& f : sums.force) largest = std::max(largest, f.norm());
  for (const int count : sums.contacts) contacts += 0.5 * count;
  return largest / (state.material.stiffness * sums.overlap / contacts);
}

TEST(Balance, NewtonsStepsReachRounding) {
  for (const double nu : {0.68, 0.75, 0.82}) {
    State state = hundred_at_rest(nu, 5);
    const Balance result = balance(state, {}, {});
    EXPECT_TRUE(result.reached) << "nu = " << nu;
    EXPECT_EQ(result.passes, 0) << "nu = " << nu;
    EXPECT_LE(result.newton_steps, 6) << "nu = " << nu;
    EXPECT_LE(result.residual, 1e-11) << "nu = " << nu;
    EXPECT_LE(residual(state), 2e-11) << "nu = " << nu;
  }
}

TEST(Balance, TheMinimiserTakesOverFarFromEquilibrium) {
  scene::Draw draw(3);
  State state = scene::random_state(100, 3, 0.8, scene::cubic(1), draw);
  const Balance result = balance(state, {}, {});
  EXPECT_GT(result.passes, 0);
  EXPECT_TRUE(result.reached);
  EXPECT_LE(residual(state), 1e-9);
}

TEST(Balance, SaysWhenItIsNotReached) {
  scene::Draw draw(3);
  State state = scene::random_state(100, 3, 0.8, scene::cubic(1), draw);
  const Balance result = balance(state, BalanceOptions{.max_passes = 1}, {});
  EXPECT_FALSE(result.reached);
  EXPECT_GT(result.residual, 1e-9);
  EXPECT_NEAR(result.residual, residual(state), 1e-9 * result.residual);
}

TEST(Balance, NothingToBalance) {
  State none;
  EXPECT_TRUE(balance(none, {}, {}).reached);
  State apart = scene::state_of(scene::cubic(1e-2), {{1e-3, {1e-3, 1e-3, 1e-3}}});
  EXPECT_TRUE(balance(apart, {}, {}).reached);
}

}  // namespace
}  // namespace grainlaw::dem
