// D9 and D20: the energy account of a driven packing (tests/long has it at N = 1000).
//   W_box = dE_pot + dE_kin + D_contact + D_background
// Powers are integrated by the trapezoidal rule, so what is left of the identity falls with dt^2. While contacts last the
// errors of Verlet's scheme do not add up; what does is left by contacts that begin or end within a step: the kick takes
// k v^2 dt^2/12 more than the spring stores, and gives as much more back with the speed e v. Over k v^2 dt^2 (1 - e^2)/12
// of m_ij v^2 (1 - e^2)/2 dissipated this is (pi dt/t_c)^2/6 of the dissipation: 8e-5 for mean pairs at t_c,min/50, w = 3
// (t_c/141), and 6.6e-4 for equal spheres at the same t_c,min/50.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/table.hpp"

namespace grainlaw::dem {
namespace {

using scene::EnergyAccount;
using scene::Family;
using testing::expect_figure;

TEST(EnergyBalance, D9UniaxialCompressionOfJammedPackings) {
  expect_figure("D9.four_packings", scene::compress_several(300, 0.75, 4, 50).residual_over_lost(),
                scene::energy_line());
}

TEST(EnergyBalance, D9WallDriven) {
  DriveOptions options;
  options.transport = Transport::wall;
  expect_figure("D9.wall", scene::compress_several(300, 0.75, 2, 50, options).residual_over_lost(),
                scene::energy_line());
}

/// Shaken packings, compressed within 20 us: short enough for every step size to follow the same path, with thousands
/// of contacts that begin and end.
double shaken_residual(double steps_per_collision) {
  DriveOptions options;
  options.strain_rate = scene::kCompression / 20e-6;
  EnergyAccount sum;
  for (std::uint64_t seed = 31; seed < 39; ++seed) {
    State state = scene::jammed({"Paper", 3, 0}, 100, 0.75, seed);
    scene::Draw draw(seed);
    scene::random_velocities(state.packing, 3, draw);
    sum += scene::compress(state, steps_per_collision, options);
  }
  return sum.residual_over_lost();
}

TEST(EnergyBalance, D9ResidualFallsWithTheSquareOfTheStep) {
  const std::vector<double> steps{12.5, 25, 50, 100, 200};
  std::vector<double> residual;
  std::vector<std::vector<std::string>> rows;
  for (const double n : steps) {
    residual.push_back(shaken_residual(n));
    const double order = residual.size() < 2 ? 0 : std::log2(residual.end()[-2] / residual.back());
    rows.push_back({fmt::format("1/{:g}", n), fmt::format("{:.2e}", residual.back()),
                    residual.size() < 2 ? "" : fmt::format("{:.2f}", order)});
  }
  testing::print_table("D9.order", {"dt/t_c,min", "residual over dissipation", "order"}, rows);
  expect_figure("D9.order_off_two", std::abs(std::log2(residual[1] / residual.back()) / 3 - 2), 0.2);
}

/// Residual over dissipation of free head-on collisions, summed over phases and over t_c/dt within 1/2 around `steps`.
double collision_residual(double contact_viscosity, double steps) {
  const Material material{2000, 1e8, contact_viscosity, 0};
  const double r = 1e-3, m = sphere_mass(material, r), t_c = collision_time(material, m / 2);
  const int phases = 4000;
  EnergyAccount sum;
  for (int n = 0; n < phases; ++n) {
    const double phase = (n + 0.5) / phases, shuffled = ((n * 7919) % phases + 0.5) / phases;
    const double dt = t_c / (steps + shuffled - 0.5);
    const double x = 8e-3, gap = (1 + phase) * dt;  // they approach at 1 m/s
    State state = scene::state_of(scene::cubic(20e-3),
                                  {{r, {x, 1e-2, 1e-2}, {0.5, 0, 0}}, {r, {x + 2 * r + gap, 1e-2, 1e-2}, {-0.5, 0, 0}}},
                                  material);
    Simulation sim = scene::start(state, dt / min_collision_time(state.packing, material));
    sim.open_ledger();
    scene::advance_at_rest(sim, static_cast<std::int64_t>(steps) + 6);
    EXPECT_EQ(sim.state().sums.E_pot, 0) << "they must have parted";
    const Ledger& ledger = sim.state().ledger;
    sum += {ledger.D_contact, ledger.E_start - kinetic_energy(sim.state().packing) - ledger.D_contact};
  }
  return sum.residual_over_lost();
}

TEST(EnergyBalance, D9CollisionsLeaveWhatTheFormulaSays) {
  double worst = 0;
  for (const double gamma : {0.05, 1.0}) {
    for (const double steps : {50.37, 100.37}) {
      const double expected = std::pow(std::numbers::pi / steps, 2) / 6;
      worst = std::max(worst, std::abs(collision_residual(gamma, steps) / expected - 1));
    }
  }
  expect_figure("D9.collision.relative_error", worst, 0.05);
}

class EnergyBalanceOfFamily : public ::testing::TestWithParam<Family> {};

// The pass line belongs to w = 3, where t_c,min/50 is 1/141 of the mean pair's collision time. Equal spheres miss it at
// t_c,min/50 (1e-4 to 4e-4, by the formula above), so the step is the shorter of the two.
TEST_P(EnergyBalanceOfFamily, D9D20UniaxialCompression) {
  const State start = scene::jammed(GetParam(), 100, 0.75, 31);
  const double m = sphere_mass(start.material, mean_radius(start.packing));
  const double t_mean = collision_time(start.material, reduced_mass(m, m));
  const double t_min = min_collision_time(start.packing, start.material);
  const EnergyAccount account = scene::compress(start, std::max(50.0, 141 * t_min / t_mean));
  expect_figure(scene::figure_name("D9", GetParam()), account.residual_over_lost(), scene::energy_line());
}

INSTANTIATE_TEST_SUITE_P(D20, EnergyBalanceOfFamily, ::testing::ValuesIn(scene::families()), scene::name_of_family);

}  // namespace
}  // namespace grainlaw::dem
