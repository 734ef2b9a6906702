// D9 and D20: the energy account of a driven packing (tests/long has it at N = 1000).
//   W_box = dE_pot + dE_kin + D_contact + D_background
// Powers are integrated by the trapezoidal rule, so what is left of the identity falls with dt^2. Two errors are of
// that order: velocities within a step, and the contacts that begin or end within one (k v^2 dt^2/12 each).

#include <gtest/gtest.h>

#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/table.hpp"

namespace grainlaw::dem {
namespace {

using scene::EnergyAccount;
using scene::Family;
using testing::figure;

TEST(EnergyBalance, D9UniaxialCompressionOfJammedPackings) {
  figure("D9.four_packings", scene::compress_several(300, 0.75, 4, 50).residual_over_lost(), 1e-4);
}

TEST(EnergyBalance, D9WallDriven) {
  DriveOptions options;
  options.transport = Transport::wall;
  figure("D9.wall", scene::compress_several(300, 0.75, 2, 50, options).residual_over_lost(), 1e-4);
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
  figure("D9.order_off_two", std::abs(std::log2(residual[1] / residual.back()) / 3 - 2), 0.2);
}

class EnergyBalanceOfFamily : public ::testing::TestWithParam<Family> {};

// The pass line belongs to w = 3, where t_c,min/50 is 1/141 of the mean pair's collision time; with equal spheres the
// same fraction of t_c,min is a three times longer step for most contacts. So the step is the shorter of the two.
TEST_P(EnergyBalanceOfFamily, D9D20UniaxialCompression) {
  const State start = scene::jammed(GetParam(), 100, 0.75, 31);
  const double m = sphere_mass(start.material, mean_radius(start.packing));
  const double t_mean = collision_time(start.material, reduced_mass(m, m));
  const double t_min = min_collision_time(start.packing, start.material);
  const EnergyAccount account = scene::compress(start, std::max(50.0, 141 * t_min / t_mean));
  figure(scene::figure_name("D9", GetParam()), account.residual_over_lost(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(D20, EnergyBalanceOfFamily, ::testing::ValuesIn(scene::families()), scene::name_of_family);

}  // namespace
}  // namespace grainlaw::dem
