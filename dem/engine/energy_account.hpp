#pragma once
// Where the energy of a simulation comes from and goes to: work of the box, losses in contacts and to the background, by the
// trapezoidal rule over its steps, beside what it has.

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

/// Opens the energy account anew at the state, all of which must be current: ledger zero, E_start and E_kin_start taken.
void open_ledger(State& state);

double kinetic_energy(const Packing& packing);  ///< of fluctuation velocities [J]

/// (W - dE - D)/(|W| + E_kin(0) + D) since the ledger was opened [-] (hard case D9); 0 when nothing happened.
double energy_residual(const State& state);

/// Enters a step of length dt [s] at whose end the totals are `sums`, which become those of the state.
void account(State& state, double dt, const PassSums& sums);

}  // namespace grainlaw::dem
