// What the vector engine's precisions are worth, beside the plain O(N^2) reference, and that its bits depend on neither the
// vector instructions nor the lists (hard case R2).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dem/element_tests/element_run.hpp"
#include "dem/engine/averages.hpp"
#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_state_bits.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/table.hpp"

namespace grainlaw::dem {
namespace {

using testing::expect_figure;

struct ForceErrors {
  double force = 0, max_force = 0;  // of a sphere, rms and largest, over the mean contact force
  double pressure = 0;              // relative, with its sign
};

/// Forces of the lanes on a packing at rest, against the reference.
template <class Real>
ForceErrors force_errors(State state) {
  Packing& p = state.packing;
  round_radii(p);
  const CellMotion still = scene::at_rest(state);
  const ReferenceSums expected = reference_sums(p, state.material, still);
  double overlap = 0;
  std::size_t meetings = 0;
  for (const int c : expected.contacts) meetings += static_cast<std::size_t>(c);
  overlap = 2 * expected.overlap / static_cast<double>(meetings);
  const double mean_force = state.material.stiffness * overlap;

  EngineOptions options;
  options.precision = std::is_same_v<Real, float> ? Precision::mixed : Precision::full;
  options.time_step_fraction = 1e-5;  // nothing moves in one step
  state.material.background_viscosity = state.material.contact_viscosity = 0;
  Simulation sim(state, options, still);
  EXPECT_TRUE(sim.lanes() && std::holds_alternative<Lanes<Real>>(sim.lanes()->lanes));
  // the power of a cell that breathes slowly is the trace of the virial
  CellMotion breath = still;
  breath.L = Eigen::Matrix3d::Identity() * 1e-3;
  sim.advance(breath, breath);
  ForceErrors errors;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d f = p.mass[i] * Eigen::Vector3d(sim.state().ax[i], sim.state().ay[i], sim.state().az[i]);
    const double error = (f - expected.force[i]).norm() / mean_force;
    errors.force += error * error / static_cast<double>(p.size());
    errors.max_force = std::max(errors.max_force, error);
  }
  errors.force = std::sqrt(errors.force);
  errors.pressure = sim.state().sums.box_power / (-1e-3 * expected.virial.trace()) - 1;
  return errors;
}

/// A relaxed packing scaled so that the mean overlap over the mean radius becomes `overlap`.
State near_jamming(double overlap, std::uint64_t seed) {
  State state = scene::jammed({"Paper", 3}, 400, 0.70, seed);
  for (int k = 0; k < 60; ++k) {
    const Observation seen = observe(scene::start(state), scene::at_rest(state), Deviator<double>::Zero());
    if (seen.mean_overlap < 1.05 * overlap) break;
    // the pressure of a jammed packing falls linearly: halve the distance to where it would vanish
    state.packing.H *= 1 + 0.25 * seen.mean_overlap;
    relax(state, {}, {}, {});
  }
  return state;
}

TEST(PrecisionTable, ForcesAndPressure) {
  std::vector<std::vector<std::string>> rows;
  for (const double nu : {0.70, 0.74, 0.82}) {
    ForceErrors worst_mixed, worst_double;
    for (const std::uint64_t seed : {3U, 4U}) {
      const State state = scene::jammed({"Paper", 3}, 1000, nu, seed);
      const ForceErrors mixed = force_errors<float>(state), full = force_errors<double>(state);
      worst_mixed = {std::max(worst_mixed.force, mixed.force), std::max(worst_mixed.max_force, mixed.max_force),
                     std::max(worst_mixed.pressure, std::abs(mixed.pressure))};
      worst_double = {0, std::max(worst_double.max_force, full.max_force),
                      std::max(worst_double.pressure, std::abs(full.pressure))};
    }
    const std::string at = fmt::format("nu{:.2f}", nu);
    expect_figure("precision.mixed.force." + at, worst_mixed.force, 1e-5);
    expect_figure("precision.mixed.P_star." + at, worst_mixed.pressure, 1e-6);
    expect_figure("precision.double.force." + at, worst_double.max_force, 1e-12);
    expect_figure("precision.double.P_star." + at, worst_double.pressure, 1e-12);
    rows.push_back({fmt::format("{:.2f}", nu), fmt::format("{:.1e}", worst_mixed.force),
                    fmt::format("{:.1e}", worst_mixed.max_force), fmt::format("{:.1e}", worst_mixed.pressure),
                    fmt::format("{:.1e}", worst_double.max_force), fmt::format("{:.1e}", worst_double.pressure)});
  }
  testing::print_table("precision", {"nu", "mixed: force, rms", "largest", "P*", "double: force, largest", "P*"}, rows);
}

// Where the pressure of a packing that is let out reaches zero, by its last two states.
TEST(PrecisionTable, JammingDensity) {
  State state = scene::jammed({"Paper", 3}, 1000, 0.70, 3);
  std::vector<double> nu, exact, mixed;
  for (const double to : {0.69, 0.68}) {
    state.packing.H *= std::cbrt(volume_fraction(state.packing) / to);
    relax(state, {}, {}, {});
    round_radii(state.packing);
    nu.push_back(volume_fraction(state.packing));
    exact.push_back(observe(scene::start(state), scene::at_rest(state), Deviator<double>::Zero()).P_star);
    mixed.push_back(exact.back() * (1 + force_errors<float>(state).pressure));
  }
  const auto nu_c = [&](const std::vector<double>& P) { return nu[1] - P[1] * (nu[0] - nu[1]) / (P[0] - P[1]); };
  ASSERT_GT(nu_c(exact), 0.64);
  ASSERT_LT(nu_c(exact), 0.68);
  expect_figure("precision.mixed.nu_c", std::abs(nu_c(mixed) - nu_c(exact)), 1e-5);
}

TEST(PrecisionTable, NearJamming) {
  const State state = near_jamming(1e-4, 3);
  const Observation seen = observe(scene::start(state), scene::at_rest(state), Deviator<double>::Zero());
  ASSERT_LT(seen.mean_overlap, 3e-4);
  ASSERT_GT(seen.mean_overlap, 3e-5);
  // of a sphere, the sum over its contacts
  expect_figure("precision.mixed.sphere_force.near_jamming_at_1e-4",
                force_errors<float>(state).force * seen.mean_overlap / 1e-4, 2e-3);
}

// Of one contact whose overlap is 1e-4 of the mean radius, anywhere in a cell of the paper's size.
TEST(PrecisionTable, OneShallowContact) {
  constexpr int kPairs = 2000;
  scene::Draw draw(5);
  double square = 0, largest = 0;
  for (int k = 0; k < kPairs; ++k) {
    const double r_1 = draw.uniform(0.5e-3, 1.5e-3), r_2 = draw.uniform(0.5e-3, 1.5e-3);
    const Eigen::Vector3d x = draw.vector(0, 40e-3), n = draw.vector(-1, 1).normalized();
    State state = scene::state_of(scene::cubic(40e-3), {{r_1, x}, {r_2, x + (r_1 + r_2 - 1e-7) * n}});
    const ForceErrors errors = force_errors<float>(state);
    square += errors.max_force * errors.max_force / kPairs;
    largest = std::max(largest, errors.max_force);
  }
  expect_figure("precision.mixed.contact_force_at_1e-4.rms", std::sqrt(square), 2e-3);
  expect_figure("precision.mixed.contact_force_at_1e-4.largest", largest, 4e-3);
}

State moving_packing() {
  State state = scene::jammed({"Paper", 3}, 300, 0.75, 7);
  scene::Draw draw(1);
  scene::random_velocities(state.packing, 20, draw);
  return state;
}

std::vector<std::uint64_t> bits_after(const State& state, const EngineOptions& options, int steps, int look_every) {
  CellMotion motion = scene::at_rest(state);
  motion.L.diagonal() << 100, -100, 30;
  Simulation sim(state, options, motion);
  for (int k = 1; k <= steps; ++k) {
    sim.advance(motion, motion);
    if (k % look_every == 0) sim.state();
  }
  return scene::bits_of(sim.state());
}

// A step that nobody looks at ends in the same pass over the spheres as the next one begins.
TEST(Synchronise, LookingAtStepsChangesNoBit) {
  int differing = 0, compared = 0;
  for (const Precision precision : {Precision::mixed, Precision::full}) {
    EngineOptions options;
    options.precision = precision;
    options.skin = 0.2;
    for (const std::string& target : vector_targets()) {
      use_vector_target(target);
      const auto unseen = bits_after(moving_packing(), options, 200, 200);
      for (const int look_every : {1, 7}) {
        differing += bits_after(moving_packing(), options, 200, look_every) == unseen ? 0 : 1;
        ++compared;
      }
    }
    use_vector_target("");
  }
  EXPECT_GE(compared, 4);
  expect_figure("steps.looks_that_change_bits", differing, 0);
}

// The same bits from vectors of any width; machines without fused multiply-add give them when asked to.
TEST(PortableBits, R2SameOnAllVectorInstructions) {
#ifdef GRAINLAW_ONE_VECTOR_SET
  GTEST_SKIP() << "one kind of vector instructions was compiled";
#endif
  const std::vector<std::string> targets = vector_targets();
  int differing = 0, compared = 0;
  for (const Precision precision : {Precision::mixed, Precision::full}) {
    EngineOptions options;
    options.precision = precision;
    options.portable_bits = true;
    use_vector_target("");
    const auto expected = bits_after(moving_packing(), options, 200, 200);
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a by words: to be compared between compilers
    for (const std::uint64_t word : expected) hash = (hash ^ word) * 0x100000001b3;
    fmt::print("hash R2.{} {:016x}\n", precision == Precision::mixed ? "mixed" : "double", hash);
    for (const std::string& target : targets) {
      use_vector_target(target);
      differing += bits_after(moving_packing(), options, 200, 200) == expected ? 0 : 1;
      ++compared;
    }
    use_vector_target("");
  }
  EXPECT_GE(compared, 2);
  fmt::print("count R2.targets {}\n", compared);
  expect_figure("R2.differing_targets", differing, 0);
}

// No force depends on the skin: positions and velocities are the same to the last bit, totals to rounding.
TEST(PortableBits, SkinChangesNoForce) {
  const State state = moving_packing();
  std::vector<double> expected;
  int differing = 0;
  for (const double skin : {0.1, 0.3, 0.8}) {
    EngineOptions options;
    options.skin = skin;
    CellMotion motion = scene::at_rest(state);
    Simulation sim(state, options, motion);
    for (int k = 0; k < 500; ++k) sim.advance(motion, motion);
    if (expected.empty()) expected = sim.state().packing.vx;
    differing += sim.state().packing.vx == expected ? 0 : 1;
  }
  expect_figure("precision.skins_that_change_forces", differing, 0);
}

// Over 20,000 steps trajectories part (chaos), averages must not: paired over packings, the mean difference of the two
// precisions vanishes within its own 99.9 % interval (t of 5 degrees of freedom: 6.87), and that interval is narrow.
TEST(PrecisionStatistics, TwentyThousandSteps) {
  constexpr int kPackings = 6;
  struct Sum {
    double d = 0, dd = 0;
    void add(double x) { d += x, dd += x * x; }
    double mean() const { return d / kPackings; }
    double half_width() const { return 6.87 * std::sqrt((dd / kPackings - mean() * mean()) / (kPackings - 1)); }
  };
  Sum pressure, contacts, fabric;
  for (std::uint64_t seed = 1; seed <= kPackings; ++seed) {
    const State state = scene::jammed({"Paper", 3}, 300, 0.74, seed);
    const auto path = resolve({volume_fraction(state.packing),
                               Branch::unloading,
                               {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, 0.10}}});
    double P[2] = {}, C[2] = {}, F[2] = {};
    for (int k = 0; k < 2; ++k) {
      ElementTestOptions options;
      options.engine.precision = k == 0 ? Precision::mixed : Precision::full;
      options.drive.strain_rate = 340;
      options.rows = 100;
      const ElementTest test = run_element_test(state, path, options, {});
      EXPECT_GT(test.steps, 15000u);
      for (const Observation& row : test.rows) {
        P[k] += row.P_star / static_cast<double>(test.rows.size());
        C[k] += row.C_star / static_cast<double>(test.rows.size());
        F[k] += row.F_v / static_cast<double>(test.rows.size());
      }
    }
    pressure.add(P[0] / P[1] - 1);
    contacts.add(C[0] / C[1] - 1);
    fabric.add(F[0] / F[1] - 1);
  }
  for (const auto& [name, sum, width] :
       {std::tuple{"P_star", pressure, 0.05}, {"C_star", contacts, 0.02}, {"F_v", fabric, 0.02}}) {
    expect_figure(fmt::format("precision.statistics.{}.over_interval", name), std::abs(sum.mean()) / sum.half_width(),
                  1);
    expect_figure(fmt::format("precision.statistics.{}.interval", name), sum.half_width(), width);
  }
}

}  // namespace
}  // namespace grainlaw::dem
