// D9 and D20: the energy account of a driven packing.
//   W_box = dE_pot + dE_kin + D_contact + D_background
// Powers are integrated by the trapezoidal rule, so what is left of the identity falls with dt^2. Two errors are of
// that order: velocities within a step, and the contacts that begin or end within one (k v^2 dt^2/12 each).

#include <gtest/gtest.h>

#include "dem/relax.hpp"
#include "tests/support/dem_families.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using scene::Family;
using testing::figure;

constexpr double kStrain = 0.01;  // of the cell's z edge

State jammed(const Family& family, std::size_t n, std::uint64_t seed) {
  Draw draw(seed);
  State state = scene::state_of_family(family, n, 0.75, draw);
  const Relaxation relaxation = relax(state, EngineOptions{}, RelaxOptions{}, RunControl{});
  EXPECT_TRUE(relaxation.relaxed);
  return state;
}

struct Account {
  double change = 0, lost = 0;  ///< of energy [J]
  double residual = 0;          ///< W - change - lost [J]
  double scaled = 0;            ///< energy_residual() [-]
};

/// Uniaxial compression by 1 % at steps of t_c,min/`steps_per_collision`.
Account compress(const State& start, double steps_per_collision, Transport transport = Transport::homogeneous,
                 double strain_rate = DriveOptions{}.strain_rate) {
  Simulation sim = scene::start(start, 1 / steps_per_collision);
  DriveOptions options;
  options.strain_rate = strain_rate;
  options.transport = transport;
  const Eigen::Vector3d direction(0, 0, -1);
  const StraightSegment segment = scene::segment_of(direction.asDiagonal(), -std::log(1 - kStrain), 0.75);
  const Drive drive = make_drive(segment, options, start.packing.H);
  scene::run_along(sim, drive);
  const Ledger& ledger = sim.state.ledger;
  Account account;
  account.lost = ledger.D_contact + ledger.D_background;
  account.change = sim.state.sums.E_pot + kinetic_energy(sim.state.packing) - ledger.E_start;
  account.residual = ledger.W_box - account.change - account.lost;
  account.scaled = energy_residual(sim);
  EXPECT_GE(ledger.D_contact, 0);
  EXPECT_GE(ledger.D_background, 0);
  EXPECT_GT(ledger.W_box, 0) << "compression of a jammed packing costs work";
  EXPECT_NEAR(account.scaled,
              account.residual / (std::abs(ledger.W_box) + ledger.E_kin_start + account.lost), 1e-15);
  return account;
}

// Several packings together, because it is up to chance how much of the dissipation one of them shows: between
// rearrangements it is 1e-5 of the work, with them up to all of it.
Account compress_paper_packings(std::size_t n, int packings, double steps_per_collision,
                                Transport transport = Transport::homogeneous) {
  Account sum;
  for (int k = 0; k < packings; ++k) {
    const Account one = compress(jammed({"Paper", 3, 0}, n, 31 + static_cast<std::uint64_t>(k)), steps_per_collision,
                                 transport);
    sum.lost += one.lost;
    sum.residual += one.residual;
  }
  return sum;
}

TEST(EnergyBalance, D9UniaxialCompressionOfJammedPackings) {
  const Account account = compress_paper_packings(300, 4, 50);
  figure("D9", std::abs(account.residual) / account.lost, 1e-4);
}

TEST(EnergyBalance, D9WallDriven) {
  const Account account = compress_paper_packings(300, 2, 50, Transport::wall);
  figure("D9.wall", std::abs(account.residual) / account.lost, 1e-4);
}

/// Residual over dissipation of shaken packings, compressed by 1 % within 20 us: short enough for every step size to
/// follow the same path, with thousands of contacts that begin and end.
double shaken_residual(double steps_per_collision) {
  Account sum;
  for (std::uint64_t seed = 31; seed < 39; ++seed) {
    State state = jammed({"Paper", 3, 0}, 100, seed);
    Draw draw(seed);
    scene::random_velocities(state.packing, 3, draw);
    const Account one = compress(state, steps_per_collision, Transport::homogeneous, kStrain / 20e-6);
    sum.lost += one.lost;
    sum.residual += one.residual;
  }
  return std::abs(sum.residual) / sum.lost;
}

TEST(EnergyBalance, D9ResidualFallsWithTheSquareOfTheStep) {
  const double coarse = shaken_residual(25), fine = shaken_residual(200);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(8.0), 2, 0.2) << coarse << " at 1/25, " << fine << " at 1/200";
}

class EnergyBalanceOfFamily : public ::testing::TestWithParam<Family> {};

// The pass line belongs to w = 3, where t_c,min/50 is 1/141 of the mean pair's collision time; with equal spheres the
// same fraction of t_c,min is a three times longer step for most contacts. So the step is the shorter of the two.
TEST_P(EnergyBalanceOfFamily, D9D20UniaxialCompression) {
  const State start = jammed(GetParam(), 100, 31);
  const double m = sphere_mass(start.material, mean_radius(start.packing));
  const double t_mean = collision_time(start.material, reduced_mass(m, m));
  const double t_min = min_collision_time(start.packing, start.material);
  const Account account = compress(start, std::max(50.0, 141 * t_min / t_mean));
  figure("D9." + GetParam().name, std::abs(account.residual) / account.lost, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(D20, EnergyBalanceOfFamily, ::testing::ValuesIn(scene::families()), scene::name_of_family);

}  // namespace
}  // namespace grainlaw::dem
