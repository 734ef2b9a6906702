#pragma once
// Jammed packings compressed by 1 % along z, and what is left of their energy balance (hard case D9).

#include <gtest/gtest.h>

#include "dem/engine/state.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_families.hpp"

namespace grainlaw::dem::scene {

constexpr double kCompression = 0.01;  ///< of the cell's z edge [-]

/// n spheres at random places of a cell at volume fraction nu, relaxed.
inline State jammed(const Family& family, std::size_t n, double nu, std::uint64_t seed) {
  Draw draw(seed);
  State state = state_of_family(family, n, nu, draw);
  EXPECT_TRUE(relax(state, EngineOptions{}, RelaxOptions{}, RunControl{}).relaxed);
  return state;
}

/// Pass line of residual over dissipation; mixed precision may take ten times that of double.
inline double energy_line() { return precision_under_test() == Precision::mixed ? 1e-3 : 1e-4; }

struct EnergyAccount {
  double lost = 0;      ///< dissipated by contacts and drag [J]
  double residual = 0;  ///< W_box - (change of E_pot + E_kin) - lost [J]

  double residual_over_lost() const { return std::abs(residual) / lost; }
  void operator+=(const EnergyAccount& other) { lost += other.lost, residual += other.residual; }
};

/// Uniaxial compression at steps of t_c,min/`steps_per_collision`.
inline EnergyAccount compress(const State& state, double steps_per_collision, const DriveOptions& options = {}) {
  Simulation sim = start(state, 1 / steps_per_collision);
  const Eigen::Vector3d direction(0, 0, -1);
  const StraightSegment segment =
      segment_of(direction.asDiagonal(), -std::log(1 - kCompression), volume_fraction(state.packing));
  run_along(sim, make_drive(segment, options, state.packing.H));
  const Ledger& ledger = sim.state().ledger;
  EXPECT_GE(ledger.D_contact, 0);
  EXPECT_GE(ledger.D_background, 0);
  EXPECT_GT(ledger.W_box, 0) << "compression of a jammed packing costs work";
  const double lost = ledger.D_contact + ledger.D_background;
  const double change = sim.state().sums.E_pot + kinetic_energy(sim.state().packing) - ledger.E_start;
  return {lost, ledger.W_box - change - lost};
}

/// Several packings of the paper's sizes together, because it is up to chance how much dissipation one of them shows:
/// between rearrangements it is 1e-5 of the work, with them up to all of it.
inline EnergyAccount compress_several(std::size_t n, double nu, int packings, double steps_per_collision,
                                      const DriveOptions& options = {}) {
  EnergyAccount sum;
  for (int k = 0; k < packings; ++k) {
    sum += compress(jammed({"Paper", 3, 0}, n, nu, 31 + static_cast<std::uint64_t>(k)), steps_per_collision, options);
  }
  return sum;
}

}  // namespace grainlaw::dem::scene
