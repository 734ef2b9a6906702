// D13, D21, D22: fabric trace and coordination numbers against a plain count, and packings too small to have any.
//   tr F = sum_p V_p C_p/V = g3 nu C, the second statistically (at N = 9261 in tests/long);   M = sum_p C_p, N4 spheres with C_p >= 4, M4 = their contacts, counted in one pass:
//   C_r = M/N, C = M4/N, C* = M4/N4, phi_r = 1 - N4/N, hence C = (1 - phi_r) C*
// A sphere with 4 contacts of which some are with rattlers stays in N4: nothing is removed iteratively.

#include <gtest/gtest.h>

#include "dem/element_tests/element_run.hpp"
#include "dem/engine/averages.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_contact_statistics.hpp"
#include "tests/support/dem_families.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using scene::Family;
using testing::expect_figure;

Observation seen_at_rest(const State& state) {
  return observe(scene::start(state), scene::at_rest(state), Deviator<double>::Zero());
}

class ContactNumbers : public ::testing::TestWithParam<Family> {};

TEST_P(ContactNumbers, D13D22EqualThePlainCount) {
  Draw draw(37);
  double trace_error = 0, number_error = 0;
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
    trace_error =
        std::max({trace_error, std::abs(seen.F_v / trace - 1), std::abs(seen.fabric.tensor.trace() / trace - 1)});
    number_error = std::max({number_error, std::abs(seen.C_r - M / 200), std::abs(seen.C - M4 / 200),
                             std::abs(seen.rattler_fraction - (1 - N4 / 200))});
    if (N4 > 0) {
      number_error = std::max({number_error, std::abs(seen.C_star - M4 / N4),
                               std::abs(seen.C - (1 - seen.rattler_fraction) * seen.C_star)});
    } else {
      EXPECT_TRUE(std::isnan(seen.C_star));
    }
  }
  expect_figure(scene::figure_name("D13.trace", GetParam()), trace_error, 1e-13);
  expect_figure(scene::figure_name("D22.numbers", GetParam()), number_error, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(D20, ContactNumbers, ::testing::ValuesIn(scene::families()), scene::name_of_family);

TEST(FabricOfManyContacts, D13TraceFollowsCoordinationAndSizes) {
  expect_figure("D13.formula_of_g3", std::abs(scene::g3_of_uniform_sizes(3) - 1.2250), 1e-4);
  EXPECT_NEAR(scene::g3_of_uniform_sizes(1 + 1e-9), 1, 1e-8);
  EXPECT_NEAR(scene::g3_of_uniform_sizes(2), 1.110, 5e-4);
  EXPECT_NEAR(scene::g3_of_uniform_sizes(8), 1.448, 5e-4);
  for (const double nu : {0.75, 0.82}) {
    expect_figure(fmt::format("D13.statistical.N1000.nu{:.2f}", nu), scene::fabric_error(1000, nu), 0.03);
  }
}

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

/// How many quantities of a row without contacts are not what they must be: 0 where a sum is empty, undefined (NaN in
/// memory, null or empty in files) where the sum would divide.
int wrong_without_contacts(const Observation& row, bool spheres) {
  int wrong = 0;
  for (const double zero :
       {row.P_star, row.stress.tensor.norm(), row.F_v, row.F_dev, row.E_pot, row.W_box, row.D_contact}) {
    wrong += zero == 0 ? 0 : 1;
  }
  for (const double undefined : {row.s_dev, row.s_par, row.C_star, row.mean_overlap, row.inertial_number,
                                 row.shape_stress, row.lode_stress, row.shape_fabric, row.lode_fabric}) {
    wrong += std::isnan(undefined) ? 0 : 1;
  }
  for (const double number : {row.C_r, row.C}) wrong += (spheres ? number == 0 : std::isnan(number)) ? 0 : 1;
  return wrong + ((spheres ? row.rattler_fraction == 1 : std::isnan(row.rattler_fraction)) ? 0 : 1);
}

State spheres_apart(std::size_t n, double speed) {
  std::vector<scene::Sphere> spheres;
  for (std::size_t i = 0; i < n; ++i) {
    const double along = static_cast<double>(i);
    spheres.push_back({1e-3, {3e-3 + 5e-3 * along, 4e-3, 5e-3}, {0, speed * (along + 1), 0}});
  }
  return scene::state_of(scene::cubic(20e-3), spheres);
}

TEST(ContactNumbersOfFew, D21NoContactsNoStressNoRatios) {
  int wrong = 0;
  for (const std::size_t n : {0U, 1U, 2U, 3U}) {
    for (const double speed : {0.0, 0.5}) {
      const State state = spheres_apart(n, speed);
      Simulation sim = scene::start(state);
      sim.open_ledger();
      scene::advance_at_rest(sim, 10);
      const Observation seen = observe(sim, scene::at_rest(state), Deviator<double>{1, 0, 0, 0, 0});
      wrong += wrong_without_contacts(seen, n > 0);
      if (speed == 0) {
        EXPECT_EQ(seen.E_kin, 0);
        EXPECT_EQ(seen.energy_residual, 0);
        EXPECT_EQ(seen.stress_kinetic.tensor, Eigen::Matrix3d::Zero());
      } else if (n > 0) {
        EXPECT_GT(seen.E_kin, 0);
      }
      EXPECT_NEAR(seen.nu, static_cast<double>(n) * 4.0 / 3.0 * std::numbers::pi / 8000, 1e-15);
    }
  }
  expect_figure("D21.wrong_quantities", wrong, 0);
}

// A whole element test of 1, 2 and 3 spheres; none can be tested without a sphere.
TEST(ContactNumbersOfFew, D21ElementTestsOfFewSpheres) {
  int wrong = 0;
  std::size_t rows = 0;
  ElementTestOptions options;
  options.engine = scene::engine_options();
  options.drive.strain_rate = 3000;
  options.rows = 10;
  for (const std::size_t n : {1U, 2U, 3U}) {
    const State state = spheres_apart(n, 0);
    const double nu = volume_fraction(state.packing);
    const std::vector<StraightSegment> path{scene::segment_of(Eigen::Vector3d(1, 0, -1).asDiagonal(), 0.02, nu)};
    for (const Observation& row : run_element_test(state, path, options, {}).rows) {
      wrong += wrong_without_contacts(row, true) + (row.energy_residual == 0 ? 0 : 1);
      ++rows;
    }
  }
  EXPECT_EQ(rows, 33U);
  expect_figure("D21.wrong_quantities_in_element_tests", wrong, 0);
  EXPECT_THROW(run_element_test(spheres_apart(0, 0), {}, options, {}), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::dem
