#pragma once
// Arranges spheres for vector arithmetic: in the order of their places, so that neighbours share cache lines, within
// windows by number of neighbours, so that few lanes idle; and lists for each the rows of its neighbours, by index, so that
// its force does not depend on the arrangement. The result depends on positions, radii and indices alone.

#include <array>

#include "dem/engine/lanes/lanes.hpp"
#include "dem/engine/thread_team.hpp"

namespace grainlaw::dem {

/// Whether spheres that reach each other over at most `cutoff` meet one image of each other only, in a rectangular cell.
bool fits_lanes(const std::array<double, 3>& edge, double cutoff);

/// Rearranges the spheres at their present positions, which become the reference; listed are all pairs nearer than
/// r_i + r_j + skin. `edge` and `skin` in internal units; groups are filled by numbers of neighbours within `near_skin`.
/// Rows are to be written and the near ones to be picked anew.
template <class Real>
void arrange(Lanes<Real>& lanes, const std::array<double, 3>& edge, double skin, double near_skin, ThreadTeam& team);

}  // namespace grainlaw::dem
