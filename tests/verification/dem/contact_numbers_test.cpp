// D13, D21, D22: fabric trace and coordination numbers against a plain count, and packings too small to have any.
//   tr F = sum_p V_p C_p/V;   M = sum_p C_p, N4 spheres with C_p >= 4, M4 = their contacts, counted in one pass:
//   C_r = M/N, C = M4/N, C* = M4/N4, phi_r = 1 - N4/N, hence C = (1 - phi_r) C*
// A sphere with 4 contacts of which some are with rattlers stays in N4: nothing is removed iteratively.

#include <gtest/gtest.h>

#include "dem/averages.hpp"
#include "dem/reference.hpp"
#include "model/error.hpp"
#include "tests/support/dem_families.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using scene::Family;

Observation seen_at_rest(const State& state) {
  return observe(scene::start(state), scene::at_rest(state), Deviator<double>::Zero());
}

class ContactNumbers : public ::testing::TestWithParam<Family> {};

TEST_P(ContactNumbers, D13D22EqualThePlainCount) {
  Draw draw(37);
  for (const double nu : {0.05, 0.2, 0.4, 0.7}) {
    const State state = scene::state_of_family(GetParam(), 200, nu, draw);
    const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
    double trace = 0, M = 0, M4 = 0, N4 = 0;
    for (std::size_t i = 0; i < state.packing.size(); ++i) {
      const double C = sums.contacts[i];
      trace += 4.0 / 3.0 * std::numbers::pi * std::pow(state.packing.radius[i], 3) * C / state.packing.volume();
      M += C;
      if (C >= 4) M4 += C, N4 += 1;
    }
    ASSERT_GT(M, 0);
    const Observation seen = seen_at_rest(state);
    EXPECT_NEAR(seen.F_v, trace, 1e-13 * trace);
    EXPECT_NEAR(seen.fabric.tensor.trace(), trace, 1e-13 * trace);
    EXPECT_DOUBLE_EQ(seen.C_r, M / 200);
    EXPECT_DOUBLE_EQ(seen.C, M4 / 200);
    EXPECT_DOUBLE_EQ(seen.rattler_fraction, 1 - N4 / 200);
    if (N4 > 0) {
      EXPECT_DOUBLE_EQ(seen.C_star, M4 / N4);
      EXPECT_NEAR(seen.C, (1 - seen.rattler_fraction) * seen.C_star, 1e-14 * seen.C);
    } else {
      EXPECT_TRUE(std::isnan(seen.C_star));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(D20, ContactNumbers, ::testing::ValuesIn(scene::families()), scene::name_of_family);

TEST(ContactNumbersOfFew, D22AllRattlers) {
  // A chain of three: 1, 2 and 1 contacts.
  const State state = scene::state_of(
      scene::cubic(20e-3), {{1e-3, {5e-3, 5e-3, 5e-3}}, {1e-3, {6.9e-3, 5e-3, 5e-3}}, {1e-3, {8.8e-3, 5e-3, 5e-3}}});
  const Observation seen = seen_at_rest(state);
  EXPECT_DOUBLE_EQ(seen.C_r, 4.0 / 3);
  EXPECT_EQ(seen.C, 0);
  EXPECT_EQ(seen.rattler_fraction, 1);
  EXPECT_TRUE(std::isnan(seen.C_star)) << "no sphere carries";
  EXPECT_GT(seen.P_star, 0);
  EXPECT_GT(seen.F_v, 0);
}

TEST(ContactNumbersOfFew, D22RattlersAreNotRemovedIteratively) {
  // One sphere touched by four others, which touch nothing else: it stays although they are rattlers.
  const double d = 1.9e-3, x = 10e-3;
  const State state = scene::state_of(
      scene::cubic(20e-3),
      {{1e-3, {x, x, x}}, {1e-3, {x + d, x, x}}, {1e-3, {x - d, x, x}}, {1e-3, {x, x + d, x}}, {1e-3, {x, x - d, x}}});
  const Observation seen = seen_at_rest(state);
  EXPECT_EQ(seen.C_star, 4);
  EXPECT_DOUBLE_EQ(seen.C, 0.8);
  EXPECT_DOUBLE_EQ(seen.rattler_fraction, 0.8);
}

TEST(ContactNumbersOfFew, D21NoContactsNoStressNoRatios) {
  for (const std::size_t n : {1U, 2U, 3U}) {
    std::vector<scene::Sphere> spheres;
    for (std::size_t i = 0; i < n; ++i) spheres.push_back({1e-3, {3e-3 + 5e-3 * static_cast<double>(i), 4e-3, 5e-3}});
    const State state = scene::state_of(scene::cubic(20e-3), spheres);
    Simulation sim = scene::start(state);
    scene::advance_at_rest(sim, 10);
    const Observation seen = observe(sim, scene::at_rest(state), Deviator<double>{1, 0, 0, 0, 0});
    EXPECT_EQ(seen.P_star, 0);
    EXPECT_EQ(seen.stress.tensor, Eigen::Matrix3d::Zero());
    EXPECT_EQ(seen.stress_kinetic.tensor, Eigen::Matrix3d::Zero());
    EXPECT_EQ(seen.F_v, 0);
    EXPECT_EQ(seen.F_dev, 0);
    EXPECT_EQ(seen.E_kin, 0);
    EXPECT_EQ(seen.E_pot, 0);
    EXPECT_EQ(seen.energy_residual, 0);
    EXPECT_EQ(seen.C_r, 0);
    EXPECT_EQ(seen.C, 0);
    EXPECT_EQ(seen.rattler_fraction, 1);
    for (const double undefined : {seen.s_dev, seen.s_par, seen.C_star, seen.mean_overlap, seen.inertial_number,
                                   seen.shape_stress, seen.lode_stress, seen.shape_fabric, seen.lode_fabric}) {
      EXPECT_TRUE(std::isnan(undefined)) << n << " spheres";
    }
    EXPECT_NEAR(seen.nu, static_cast<double>(n) * 4.0 / 3.0 * std::numbers::pi / 8000, 1e-15);
  }
}

TEST(ContactNumbersOfFew, D21NoSpheres) {
  const State state = scene::state_of(scene::cubic(20e-3), {});
  Simulation sim = scene::start(state);
  scene::advance_at_rest(sim, 3);
  const Observation seen = observe(sim, scene::at_rest(state), Deviator<double>::Zero());
  EXPECT_EQ(seen.P_star, 0);
  EXPECT_EQ(seen.nu, 0);
  EXPECT_EQ(seen.F_v, 0);
  EXPECT_EQ(seen.E_kin, 0);
  for (const double undefined : {seen.s_dev, seen.C_r, seen.C, seen.C_star, seen.rattler_fraction, seen.mean_overlap}) {
    EXPECT_TRUE(std::isnan(undefined));
  }
}

}  // namespace
}  // namespace grainlaw::dem
