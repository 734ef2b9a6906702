#pragma once
// What a packing shows of itself: Eqs. (5)-(10) and section 4.1 of the paper, by the sums of dem/engine/contact_sums.hpp over
// the engine's own contacts, and what its state says besides. sigma has the kinetic part apart: (1/V) sum_p m v v.

#include "dem/engine/contact_sums.hpp"
#include "dem/engine/simulation.hpp"
#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

/// The sums over the contacts of a packing with these radii; the same bits with any team.
ContactSums sum_contacts(const ForceField& field, const std::vector<double>& radius, ThreadTeam& team);

/// Measures the simulation at its current time. `motion` is the cell's at this instant (viscous forces, rate of the
/// inertial number); `N` the direction for s_par and F_par (zero: they are undefined). Strain, segment, shear_path
/// and shape/Lode of strain are the caller's: they come from the path. Ledger quantities are filled from the state.
Observation observe(Simulation& sim, const CellMotion& motion, const Deviator<double>& N);
inline Observation observe(Simulation&& sim, const CellMotion& motion, const Deviator<double>& N) {
  return observe(sim, motion, N);
}

}  // namespace grainlaw::dem
