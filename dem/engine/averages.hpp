#pragma once
// What a packing shows of itself: Eqs. (5)-(10) and section 4.1 of the paper. The only place where units are dropped.
//   sigma = (1/V) [sum_p m v v + sum_c f n l],  compression positive, l the branch vector x_ij
//   F     = (1/V) sum_p V_p sum_{c in p} n n
//   M = contacts counted per sphere (twice in all), N4 spheres with >= 4 contacts, M4 contacts of those; one counting
//   pass, rattlers are not removed iteratively: C_r = M/N, C = M4/N, C* = M4/N4, phi_r = 1 - N4/N.
// <r> is the packing's own mean.

#include "dem/engine/simulation.hpp"
#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

/// Measures the simulation at its current time. `motion` is the cell's at this instant (viscous forces, rate of the
/// inertial number); `N` the direction for s_par and F_par (zero: they are undefined). Strain, segment, shear_path
/// and shape/Lode of strain are the caller's: they come from the path. Ledger quantities are filled from the state.
Observation observe(Simulation& sim, const CellMotion& motion, const Deviator<double>& N);
inline Observation observe(Simulation&& sim, const CellMotion& motion, const Deviator<double>& N) {
  return observe(sim, motion, N);
}

}  // namespace grainlaw::dem
