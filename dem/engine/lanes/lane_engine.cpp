#include "dem/engine/lanes/lane_engine.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "dem/engine/lanes/lane_list.hpp"
#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/lane_state.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kRounding = 1e-5;  // of distances in single precision

// Near skins of spheres: for so many steps at their speed, the rest over the list's skin. Measured, docs/performance-log.md.
constexpr double kNearSteps = 70, kNearMemory = 0.92, kLeastNearSkin = 0.05, kMostNearSkin = 0.3;
// A list is made when two spheres may have come so near each other that less than this is left for their near skins together.
constexpr double kLeftForNear = 0.15;

double left_for_near(const Simulation& sim) { return kLeftForNear * sim.list.skin; }  // [m]

/// Calls visit(lanes) with the lanes of the simulation, which must be on them.
template <class Sim, class Visit>
auto with_lanes(Sim& sim, const Visit& visit) {
  if (auto* mixed = std::get_if<Lanes<float>>(&sim.lanes)) return visit(*mixed);
  return visit(std::get<Lanes<double>>(sim.lanes));
}

bool diagonal(const Eigen::Matrix3d& m) { return m.isDiagonal(0); }

std::array<double, 3> edges(const Eigen::Matrix3d& H, const Units& unit) {
  return {H(0, 0) / unit.length, H(1, 1) / unit.length, H(2, 2) / unit.length};
}

template <class Real>
LaneStep step_of(const Simulation& sim, const Lanes<Real>& lanes) {
  const Units& unit = lanes.unit;
  const Material& material = sim.state.material;
  LaneStep step;
  step.half_dt = sim.dt / 2 / unit.time;
  step.stiffness = material.stiffness / (unit.mass / unit.time / unit.time);
  step.viscosity = material.contact_viscosity / (unit.mass / unit.time);
  step.drag = material.background_viscosity / (unit.mass / unit.time);
  step.portable_bits = sim.options.portable_bits;
  return step;
}

/// The shortest that a distance in the cell `since` [m] may have become, over what it was.
double stretch(const Simulation& sim, const Eigen::Matrix3d& since) {
  return std::min(1.0, (sim.state.packing.H.diagonal().array() / since.diagonal().array()).minCoeff());
}

/// How far a sphere may move against the cell from when the list was made, so that all pairs up to `near` apart [m] are still in it.
/// In internal units.
template <class Real>
double allowed(const Simulation& sim, const Lanes<Real>& lanes, double near) {
  const double touch = 2 * sim.list.r_max;
  return (stretch(sim, sim.state.ref_H) * (touch + sim.list.skin) - (touch + near)) / 2 * (1 - kRounding) / lanes.unit.length;
}

/// For the first half of a step.
template <class Real>
LaneStep drift_step(const Simulation& sim, const Lanes<Real>& lanes, const CellMotion& half) {
  LaneStep step = step_of(sim, lanes);
  step.edge = edges(sim.state.packing.H, lanes.unit);
  const std::array<double, 3> edge = edges(half.H, lanes.unit);
  for (std::size_t a = 0; a < 3; ++a) step.drift[a] = 2 * step.half_dt / edge[a] * kQuantaPerEdge<Real>;
  step.allowed = allowed(sim, lanes, left_for_near(sim));
  const double near_stretch = stretch(sim, sim.near_H);
  step.near_stretch = near_stretch * (1 - kRounding);
  step.near_loss = (1 - near_stretch) * sim.list.r_max / lanes.unit.length;
  const double growth = std::max(1.0, (sim.state.packing.H.diagonal().array() / sim.near_H.diagonal().array()).maxCoeff());
  step.list_in_danger = !(sim.near_reach / lanes.unit.length * growth < step.allowed * (1 - kRounding));
  return step;
}

/// For the second.
template <class Real>
LaneStep kick_step(const Simulation& sim, const Lanes<Real>& lanes, const CellMotion& end) {
  LaneStep step = step_of(sim, lanes);
  step.edge = edges(end.H, lanes.unit);
  for (int a = 0; a < 3; ++a) step.rate[static_cast<std::size_t>(a)] = end.L(a, a) * lanes.unit.time;
  return step;
}

LaneSums sum_of(const std::vector<LaneSums>& parts) {
  LaneSums sum;
  for (const LaneSums& part : parts) {
    sum.box_power += part.box_power;
    sum.contact_power += part.contact_power;
    sum.v2 += part.v2;
  }
  return sum;
}

PassSums in_SI(const LaneSums& sum, const Simulation& sim, const Units& unit) {
  const double speed = unit.length / unit.time, power = unit.mass * speed * speed / unit.time;
  return {sum.box_power * power, sum.contact_power * power, sim.state.sums.E_pot,
          sim.state.material.background_viscosity * sum.v2 * speed * speed};
}

/// Calls work(block, begin, end) for the groups of each block of spheres.
template <class Real, class Work>
void for_each_block_of_groups(const Simulation& sim, const Lanes<Real>& lanes, const Work& work) {
  constexpr std::size_t per_block = kBlockSize / kLanes;
  sim.team->for_each_block(block_count(lanes.spheres), [&](std::size_t block) {
    work(block, block * per_block, std::min(lanes.group.size(), (block + 1) * per_block));
  });
}

template <class Real>
void refresh_rows(const Simulation& sim, Lanes<Real>& lanes) {
  const LaneStep step = step_of(sim, lanes);
  for_each_block_of_groups(sim, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { write_rows(lanes, step, begin, end); });
}

/// Brings the groups up to their rows, where steps have left them behind.
template <class Real>
void take_rows_of(const Simulation& sim, Lanes<Real>& lanes) {
  if (!lanes.rows_ahead) return;
  for_each_block_of_groups(sim, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { take_rows(lanes, begin, end); });
  lanes.rows_ahead = false;
  lanes.predicted = true;
}

}  // namespace

bool moves_as_lanes_do(const CellMotion& motion) {
  return motion.transport == Transport::homogeneous && diagonal(motion.H) && diagonal(motion.L);
}

bool suits_lanes(const Simulation& sim, const CellMotion& motion) {
  const Eigen::Matrix3d& H = motion.H;
  return sim.options.precision != Precision::reference && moves_as_lanes_do(motion) && sim.state.packing.size() > 0 &&
         fits_lanes({H(0, 0), H(1, 1), H(2, 2)}, 2 * sim.list.r_max + sim.list.skin);
}

void enter_lanes(Simulation& sim) {
  if (sim.options.precision == Precision::mixed) {
    sim.lanes = make_lanes<float>(sim.state, sim.dt, sim.list.skin, left_for_near(sim), *sim.team);
  } else {
    sim.lanes = make_lanes<double>(sim.state, sim.dt, sim.list.skin, left_for_near(sim), *sim.team);
  }
  with_lanes(sim, [&](auto& lanes) { refresh_rows(sim, lanes); });
  sim.near_step = -1;
  repick_near(sim);
}

Drifted drift_lanes(Simulation& sim, const CellMotion& half) {
  return with_lanes(sim, [&](auto& lanes) {
    const LaneStep step = drift_step(sim, lanes, half);
    std::vector<Drifted> how(block_count(lanes.spheres));
    for_each_block_of_groups(sim, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      how[block] = kick_and_drift(lanes, step, begin, end);
    });
    return *std::max_element(how.begin(), how.end());
  });
}

bool list_still_holds(Simulation& sim) {
  return with_lanes(sim, [&]<class Real>(Lanes<Real>& lanes) {
    take_rows_of(sim, lanes);
    LaneStep step = step_of(sim, lanes);
    step.edge = edges(sim.state.packing.H, lanes.unit);
    const double most = allowed(sim, lanes, left_for_near(sim));
    std::vector<double> moved2(block_count(lanes.spheres));
    for_each_block_of_groups(sim, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      moved2[block] = farthest_moved2(lanes, step, begin, end);
    });
    const double farthest2 = *std::max_element(moved2.begin(), moved2.end());
    return most > 0 && farthest2 < static_cast<double>(static_cast<Real>(most * most));
  });
}

void repick_near(Simulation& sim) {
  sim.near_H = sim.state.packing.H;
  with_lanes(sim, [&](auto& lanes) {
    take_rows_of(sim, lanes);
    const std::array<double, 3> edge = edges(sim.near_H, lanes.unit);
    const double skin = sim.list.skin / lanes.unit.length, dt = sim.dt / lanes.unit.time;
    const double steps = sim.near_step < 0 ? 0 : static_cast<double>(sim.state.step - sim.near_step);
    const NearSkins skins{kNearSteps * dt, steps * dt, kNearMemory, kLeastNearSkin * skin, kMostNearSkin * skin, allowed(sim, lanes, 0)};
    std::vector<double> reach(block_count(lanes.spheres));
    for_each_block_of_groups(sim, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      reach[block] = choose_near_skins(lanes, edge, skins, begin, end);
    });
    sim.near_reach = *std::max_element(reach.begin(), reach.end()) * lanes.unit.length;
    sim.near_step = sim.state.step;
    for_each_block_of_groups(sim, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { pick_near(lanes, edge, begin, end); });
  });
}

void rearrange_lanes(Simulation& sim) {
  with_lanes(sim, [&](auto& lanes) {
    take_rows_of(sim, lanes);
    const double length = lanes.unit.length;
    arrange(lanes, edges(sim.state.packing.H, lanes.unit), sim.list.skin / length, left_for_near(sim) / length, *sim.team);
    refresh_rows(sim, lanes);
  });
  sim.near_step = -1;
  repick_near(sim);
}

PassSums kick_lanes(Simulation& sim, const CellMotion& end) {
  return with_lanes(sim, [&](auto& lanes) {
    const LaneStep step = kick_step(sim, lanes, end);
    std::vector<LaneSums> parts(block_count(lanes.spheres));
    for_each_block_of_groups(sim, lanes, [&](std::size_t block, std::size_t first, std::size_t last) {
      parts[block] = force_and_kick(lanes, step, first, last);
    });
    lanes.rows_ahead = lanes.predicted = false;
    return in_SI(sum_of(parts), sim, lanes.unit);
  });
}

KickAndDrift kick_and_drift_lanes(Simulation& sim, const CellMotion& end, const CellMotion& half) {
  return with_lanes(sim, [&](auto& lanes) {
    const LaneStep step = kick_step(sim, lanes, end), next = drift_step(sim, lanes, half);
    std::vector<LaneSums> parts(block_count(lanes.spheres));
    std::vector<Drifted> how(parts.size());
    for_each_block_of_groups(sim, lanes, [&](std::size_t block, std::size_t first, std::size_t last) {
      parts[block] = force_kick_drift(lanes, step, next, first, last, how[block]);
    });
    std::swap(lanes.row, lanes.next_row);
    lanes.rows_ahead = true;
    return KickAndDrift{in_SI(sum_of(parts), sim, lanes.unit), *std::max_element(how.begin(), how.end())};
  });
}

void read_lanes(Simulation& sim) {
  with_lanes(sim, [&](auto& lanes) {
    take_rows_of(sim, lanes);
    store_lanes(lanes, sim.state);
    sim.state.sums.E_pot = 0.25 * sim.state.material.stiffness * sum_squared_overlaps(lanes, sim.state.packing.H);
  });
}

void read_predicted(Simulation& sim) {
  with_lanes(sim, [&](const auto& lanes) {
    const double speed = lanes.unit.length / lanes.unit.time;
    for (std::size_t t = 0; t < lanes.spheres; ++t) {
      const auto& row = lanes.row[t];
      sim.motion[lanes.listed[t / kLanes].sphere[t % kLanes]] = {row.vx * speed, row.vy * speed, row.vz * speed, 0};
    }
  });
}

}  // namespace grainlaw::dem
