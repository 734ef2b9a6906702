#pragma once
// Time steps on lanes (dem/engine/lanes/lanes.hpp), for a Simulation that runs on them.

#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/simulation.hpp"

namespace grainlaw::dem {

/// Whether lanes know this motion: a rectangular cell that moves its spheres with it.
bool moves_as_lanes_do(const CellMotion& motion);

/// Whether a simulation in this motion can run on lanes; its cell must be large enough, too.
bool suits_lanes(const Simulation& sim, const CellMotion& motion);

/// Puts the simulation on lanes; accelerations and the list's reference must be known.
void enter_lanes(Simulation& sim);

/// First half of a step: kick, drift.
Drifted drift_lanes(Simulation& sim, const CellMotion& half);

/// Whether all pairs that near ones are picked from are in the list.
bool list_still_holds(Simulation& sim);

/// New near ones, after that question, or a new list at the present positions, in the middle of a step.
void repick_near(Simulation& sim);
void rearrange_lanes(Simulation& sim);

/// Second half: forces and kick. Returns the totals of the state at its end, E_pot as it was.
PassSums kick_lanes(Simulation& sim, const CellMotion& end);

/// Second half of the step that ended with `end` and the first of the next in one pass over the spheres: the same bits in
/// less time. The cell of the state must be that at the end of the next step.
struct KickAndDrift {
  PassSums sums;
  Drifted how;
};
KickAndDrift kick_and_drift_lanes(Simulation& sim, const CellMotion& end, const CellMotion& half);

/// Arrays and E_pot of the state from the lanes; in the middle of a step accelerations stay.
void read_lanes(Simulation& sim);

/// In the middle of a step: Simulation::motion from the rows.
void read_predicted(Simulation& sim);

}  // namespace grainlaw::dem
