#pragma once
// Where the energy of a simulation comes from and goes to: work of the box, losses in contacts and to the background, by the
// trapezoidal rule over its steps, beside what it has.

#include "dem/engine/simulation.hpp"

namespace grainlaw::dem {

/// Opens the energy account anew at the current state: ledger zero, E_start taken.
void open_ledger(Simulation& sim);

double kinetic_energy(const Packing& packing);  ///< of fluctuation velocities [J]

/// (W - dE - D)/(|W| + E_kin(0) + D) since the ledger was opened [-] (hard case D9); 0 when nothing happened.
double energy_residual(const Simulation& sim);

/// Enters a step of length sim.dt at whose end the totals are `sums`.
void account(Simulation& sim, const PassSums& sums);

}  // namespace grainlaw::dem
