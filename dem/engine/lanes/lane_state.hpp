#pragma once
// Between a State and its lanes. A State made from lanes is exact: it gives the same lanes again, bit for bit.

#include "dem/engine/lanes/lanes.hpp"
#include "dem/engine/neighbour_list.hpp"
#include "dem/engine/state.hpp"
#include "dem/engine/thread_team.hpp"

namespace grainlaw::dem {

/// The lanes of a state whose accelerations and list reference are known; rows are to be written and the near ones to be
/// picked. `dt` [s] sets the unit of time, the skins [m] are those of the list and of the near ones.
template <class Real>
Lanes<Real> make_lanes(const State& state, double dt, double skin, double near_skin, ThreadTeam& team);

/// Positions, velocities, accelerations and the list's reference, into arrays of the right size.
template <class Real>
void store_lanes(const Lanes<Real>& lanes, State& state);

/// Sum of squared overlaps [m^2], every contact twice, in double precision whatever the lanes'.
template <class Real>
double sum_squared_overlaps(const Lanes<Real>& lanes, const Eigen::Matrix3d& H);

enum class Listed { all, near };

/// All of the list, or those picked last, for sums over the contacts of `packing`, whose fractions may lie outside the
/// cell. Spheres and neighbours in the order of the packing.
template <class Real>
NeighbourList plain_list(const Lanes<Real>& lanes, const Packing& packing, Listed which);

}  // namespace grainlaw::dem
