#pragma once
// The passes of a time step over groups of sixteen spheres, on the widest vectors that the machine has. Equations:
// dem/engine/contact_law.hpp and dem/engine/simulation.hpp. Everything in internal units (dem/engine/lanes/lanes.hpp).

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "dem/engine/lanes/lanes.hpp"
#include "dem/engine/stepping.hpp"

namespace grainlaw::dem {

/// What a step of length dt is made of, rectangular cells only.
struct LaneStep {
  double half_dt = 0;
  std::array<double, 3> drift{};  ///< quanta of the fixed point per velocity, at dt/2
  std::array<double, 3> edge{};   ///< of the cell at the end of the step
  std::array<double, 3> rate{};   ///< L there, diagonal
  double allowed = 0;             ///< a sphere may move against the cell since the list was made
  bool list_in_danger = true;     ///< false: it cannot have moved so far while the near ones last
  double near_stretch = 0, near_loss = 0;  ///< it may move near_stretch * near_skin - near_loss since the near ones were picked
  double stiffness = 0, viscosity = 0, drag = 0;  ///< k, gamma, gamma_b
  bool portable_bits = false;     ///< round as machines with a fused a b + c do, at a price where there is none
};

/// Sums over a range of groups.
struct LaneSums {
  double box_power = 0, contact_power = 0;
  double v2 = 0;  ///< sum of squared velocities
};

/// Rows of the groups [begin, end) from positions and velocities, the latter predicted by dt/2 (or as they were, Lanes::predicted).
void write_rows(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);
void write_rows(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);

/// The other way, after force_kick_drift(): positions, and predicted velocities in place of accelerations.
template <class Real>
void take_rows(Lanes<Real>& lanes, std::size_t begin, std::size_t end) {
  for (std::size_t t = begin * kLanes; t < end * kLanes; ++t) {
    PlacedGroup<Real>& own = lanes.placed[t / kLanes];
    const SphereRow<Real>& row = lanes.row[t];
    const std::size_t l = t % kLanes;
    own.x[l] = row.x, own.y[l] = row.y, own.z[l] = row.z;
    own.ax[l] = row.vx, own.ay[l] = row.vy, own.az[l] = row.vz;
  }
}

/// Half kick, drift, rows.
Drifted kick_and_drift(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);
Drifted kick_and_drift(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);

/// How far a sphere has moved against the cell since the list was made, squared, at most.
double farthest_moved2(const Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);
double farthest_moved2(const Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);

/// Contact forces from the rows, then the second half kick with implicit drag. Brings groups up to their rows.
LaneSums force_and_kick(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);
LaneSums force_and_kick(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end);

/// Second half of `step` and the first of `next` at once: what kick_and_drift() would say is left in `how`. The rows after the
/// drift are written to lanes.next_row, as those of the spheres that come later are still read; groups keep velocities only.
LaneSums force_kick_drift(Lanes<float>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how);
LaneSums force_kick_drift(Lanes<double>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how);

/// Names of the vector instructions that this machine can use, best first; what the passes use is the first of them.
std::vector<std::string> vector_targets();

/// For tests and measurements: use `name` of vector_targets(), or "" for the best again.
void use_vector_target(const std::string& name);

}  // namespace grainlaw::dem
