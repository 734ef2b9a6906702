#pragma once
// Time steps on lanes (dem/engine/lanes/lanes.hpp): vectors over spheres, in mixed or in double precision. While a state is
// stepped on lanes, its arrays, sums and ledger are as old as the last read_lanes(), its cell, step and time are current. The
// second half of a step is left undone until the next step or end_step(): the two in one pass over the spheres take less time.

#include <optional>
#include <variant>

#include "dem/engine/contacts.hpp"
#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "dem/engine/stepping.hpp"

namespace grainlaw::dem {

struct LaneEngine {
  std::variant<Lanes<float>, Lanes<double>> lanes;
  Eigen::Matrix3d near_H = Eigen::Matrix3d::Zero();  ///< cell when the near ones were picked [m]
  std::int64_t near_step = -1;         ///< step when they were, -1: not since the list was made
  double near_reach = 0;               ///< how far a sphere may have moved since the list was made, at most, while the near ones last [m]
  std::optional<CellMotion> unkicked;  ///< end of a step whose forces wait to be taken with the next step's drift
};

/// Whether lanes know this motion: a rectangular cell that moves its spheres with it.
bool moves_as_lanes_do(const CellMotion& motion);

/// Whether a state in this motion can be stepped on lanes; its cell must be large enough, too.
bool suits_lanes(const Stepping& s, const CellMotion& motion);

/// Puts the state on lanes; its accelerations and its list's reference must be known.
LaneEngine enter_lanes(Stepping& s);

/// What is left of the step before, then the first half of a step: kick, drift. The cell of the state must be that at its end.
Drifted drift(LaneEngine& engine, Stepping& s, const CellMotion& half);

/// Whether all pairs that near ones are picked from are in the list.
bool list_still_holds(LaneEngine& engine, Stepping& s);

/// New near ones, after that question, or a new list at the present positions, in the middle of a step.
void repick_near(LaneEngine& engine, Stepping& s);
void rearrange_lanes(LaneEngine& engine, Stepping& s);

/// What is left of the step before.
void end_step(LaneEngine& engine, Stepping& s);

/// Arrays and E_pot of the state from the lanes; in the middle of a step accelerations stay.
void read_lanes(LaneEngine& engine, Stepping& s);

/// In the middle of a step: the velocities predicted to its end [m/s], in the order of the state.
std::vector<Row> predicted_velocities(const LaneEngine& engine);

/// The lists of the lanes as neighbours of `packing`, the state as read last.
NeighbourList list_of(const LaneEngine& engine, const Packing& packing, Listed which);

}  // namespace grainlaw::dem
