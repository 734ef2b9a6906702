#include "dem/engine/lanes/lane_engine.hpp"

#include <algorithm>
#include <utility>

#include "dem/engine/state.hpp"
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

double left_for_near(const Stepping& s) { return kLeftForNear * s.skin; }  // [m]

/// Calls visit(lanes) with the lanes of the engine, whatever their precision.
template <class Engine, class Visit>
auto with_lanes(Engine& engine, const Visit& visit) {
  if (auto* mixed = std::get_if<Lanes<float>>(&engine.lanes)) return visit(*mixed);
  return visit(std::get<Lanes<double>>(engine.lanes));
}

bool diagonal(const Eigen::Matrix3d& m) { return m.isDiagonal(0); }

std::array<double, 3> edges(const Eigen::Matrix3d& H, const Units& unit) {
  return {H(0, 0) / unit.length, H(1, 1) / unit.length, H(2, 2) / unit.length};
}

template <class Real>
LaneStep step_of(const Stepping& s, const Lanes<Real>& lanes) {
  const Units& unit = lanes.unit;
  const Material& material = s.state.material;
  LaneStep step;
  step.half_dt = s.dt / 2 / unit.time;
  step.stiffness = material.stiffness / (unit.mass / unit.time / unit.time);
  step.viscosity = material.contact_viscosity / (unit.mass / unit.time);
  step.drag = material.background_viscosity / (unit.mass / unit.time);
  step.portable_bits = s.options.portable_bits;
  return step;
}

/// The shortest that a distance in the cell `since` [m] may have become, over what it was.
double stretch(const Stepping& s, const Eigen::Matrix3d& since) {
  return std::min(1.0, (s.state.packing.H.diagonal().array() / since.diagonal().array()).minCoeff());
}

/// How far a sphere may move against the cell from when the list was made, so that all pairs up to `near` apart [m] are still in it.
/// In internal units.
template <class Real>
double allowed(const Stepping& s, const Lanes<Real>& lanes, double near) {
  const double touch = 2 * s.r_max;
  return (stretch(s, s.state.ref_H) * (touch + s.skin) - (touch + near)) / 2 * (1 - kRounding) / lanes.unit.length;
}

/// For the first half of a step.
template <class Real>
LaneStep drift_step(const LaneEngine& engine, const Stepping& s, const Lanes<Real>& lanes, const CellMotion& half) {
  LaneStep step = step_of(s, lanes);
  step.edge = edges(s.state.packing.H, lanes.unit);
  const std::array<double, 3> edge = edges(half.H, lanes.unit);
  for (std::size_t a = 0; a < 3; ++a) step.drift[a] = 2 * step.half_dt / edge[a] * kQuantaPerEdge<Real>;
  step.allowed = allowed(s, lanes, left_for_near(s));
  const double near_stretch = stretch(s, engine.near_H);
  step.near_stretch = near_stretch * (1 - kRounding);
  step.near_loss = (1 - near_stretch) * s.r_max / lanes.unit.length;
  const double growth = std::max(1.0, (s.state.packing.H.diagonal().array() / engine.near_H.diagonal().array()).maxCoeff());
  step.list_in_danger = !(engine.near_reach / lanes.unit.length * growth < step.allowed * (1 - kRounding));
  return step;
}

/// For the second.
template <class Real>
LaneStep kick_step(const Stepping& s, const Lanes<Real>& lanes, const CellMotion& end) {
  LaneStep step = step_of(s, lanes);
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

PassSums in_SI(const LaneSums& sum, const Stepping& s, const Units& unit) {
  const double speed = unit.length / unit.time, power = unit.mass * speed * speed / unit.time;
  return {sum.box_power * power, sum.contact_power * power, s.state.sums.E_pot,
          s.state.material.background_viscosity * sum.v2 * speed * speed};
}

/// Calls work(block, begin, end) for the groups of each block of spheres.
template <class Real, class Work>
void for_each_block_of_groups(const Stepping& s, const Lanes<Real>& lanes, const Work& work) {
  constexpr std::size_t per_block = kBlockSize / kLanes;
  s.team->for_each_block(block_count(lanes.spheres), [&](std::size_t block) {
    work(block, block * per_block, std::min(lanes.group.size(), (block + 1) * per_block));
  });
}

template <class Real>
void refresh_rows(const Stepping& s, Lanes<Real>& lanes) {
  const LaneStep step = step_of(s, lanes);
  for_each_block_of_groups(s, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { write_rows(lanes, step, begin, end); });
}

/// Brings the groups up to their rows, where steps have left them behind.
template <class Real>
void take_rows_of(const Stepping& s, Lanes<Real>& lanes) {
  if (!lanes.rows_ahead) return;
  for_each_block_of_groups(s, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { take_rows(lanes, begin, end); });
  lanes.rows_ahead = false;
  lanes.predicted = true;
}

/// First half of a step: kick, drift.
Drifted drift_lanes(LaneEngine& engine, const Stepping& s, const CellMotion& half) {
  return with_lanes(engine, [&](auto& lanes) {
    const LaneStep step = drift_step(engine, s, lanes, half);
    std::vector<Drifted> how(block_count(lanes.spheres));
    for_each_block_of_groups(s, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      how[block] = kick_and_drift(lanes, step, begin, end);
    });
    return *std::max_element(how.begin(), how.end());
  });
}

/// Second half: forces and kick. Returns the totals of the state at its end, E_pot as it was.
PassSums kick_lanes(LaneEngine& engine, const Stepping& s, const CellMotion& end) {
  return with_lanes(engine, [&](auto& lanes) {
    const LaneStep step = kick_step(s, lanes, end);
    std::vector<LaneSums> parts(block_count(lanes.spheres));
    for_each_block_of_groups(s, lanes, [&](std::size_t block, std::size_t first, std::size_t last) {
      parts[block] = force_and_kick(lanes, step, first, last);
    });
    lanes.rows_ahead = lanes.predicted = false;
    return in_SI(sum_of(parts), s, lanes.unit);
  });
}

/// Second half of the step that ended with `end` and the first of the next in one pass over the spheres: the same bits in
/// less time. The cell of the state must be that at the end of the next step.
Drifted kick_and_drift_lanes(LaneEngine& engine, Stepping& s, const CellMotion& end, const CellMotion& half) {
  return with_lanes(engine, [&](auto& lanes) {
    const LaneStep step = kick_step(s, lanes, end), next = drift_step(engine, s, lanes, half);
    std::vector<LaneSums> parts(block_count(lanes.spheres));
    std::vector<Drifted> how(parts.size());
    for_each_block_of_groups(s, lanes, [&](std::size_t block, std::size_t first, std::size_t last) {
      parts[block] = force_kick_drift(lanes, step, next, first, last, how[block]);
    });
    std::swap(lanes.row, lanes.next_row);
    lanes.rows_ahead = true;
    account(s.state, s.dt, in_SI(sum_of(parts), s, lanes.unit));
    return *std::max_element(how.begin(), how.end());
  });
}

}  // namespace

bool moves_as_lanes_do(const CellMotion& motion) {
  return motion.transport == Transport::homogeneous && diagonal(motion.H) && diagonal(motion.L);
}

bool suits_lanes(const Stepping& s, const CellMotion& motion) {
  const Eigen::Matrix3d& H = motion.H;
  return s.options.precision != Precision::reference && moves_as_lanes_do(motion) && s.state.packing.size() > 0 &&
         fits_lanes({H(0, 0), H(1, 1), H(2, 2)}, 2 * s.r_max + s.skin);
}

LaneEngine enter_lanes(Stepping& s) {
  LaneEngine engine;
  if (s.options.precision == Precision::mixed) {
    engine.lanes = make_lanes<float>(s.state, s.dt, s.skin, left_for_near(s), *s.team);
  } else {
    engine.lanes = make_lanes<double>(s.state, s.dt, s.skin, left_for_near(s), *s.team);
  }
  with_lanes(engine, [&](auto& lanes) { refresh_rows(s, lanes); });
  repick_near(engine, s);
  return engine;
}

Drifted drift(LaneEngine& engine, Stepping& s, const CellMotion& half) {
  if (!engine.unkicked) return drift_lanes(engine, s, half);
  return kick_and_drift_lanes(engine, s, *std::exchange(engine.unkicked, {}), half);
}

void end_step(LaneEngine& engine, Stepping& s) {
  if (engine.unkicked) account(s.state, s.dt, kick_lanes(engine, s, *std::exchange(engine.unkicked, {})));
}

bool list_still_holds(LaneEngine& engine, Stepping& s) {
  return with_lanes(engine, [&]<class Real>(Lanes<Real>& lanes) {
    take_rows_of(s, lanes);
    LaneStep step = step_of(s, lanes);
    step.edge = edges(s.state.packing.H, lanes.unit);
    const double most = allowed(s, lanes, left_for_near(s));
    std::vector<double> moved2(block_count(lanes.spheres));
    for_each_block_of_groups(s, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      moved2[block] = farthest_moved2(lanes, step, begin, end);
    });
    const double farthest2 = *std::max_element(moved2.begin(), moved2.end());
    return most > 0 && farthest2 < static_cast<double>(static_cast<Real>(most * most));
  });
}

void repick_near(LaneEngine& engine, Stepping& s) {
  engine.near_H = s.state.packing.H;
  with_lanes(engine, [&](auto& lanes) {
    take_rows_of(s, lanes);
    const std::array<double, 3> edge = edges(engine.near_H, lanes.unit);
    const double skin = s.skin / lanes.unit.length, dt = s.dt / lanes.unit.time;
    const double steps = engine.near_step < 0 ? 0 : static_cast<double>(static_cast<std::int64_t>(s.state.step) - engine.near_step);
    const NearSkins skins{kNearSteps * dt, steps * dt, kNearMemory, kLeastNearSkin * skin, kMostNearSkin * skin, allowed(s, lanes, 0)};
    std::vector<double> reach(block_count(lanes.spheres));
    for_each_block_of_groups(s, lanes, [&](std::size_t block, std::size_t begin, std::size_t end) {
      reach[block] = choose_near_skins(lanes, edge, skins, begin, end);
    });
    engine.near_reach = *std::max_element(reach.begin(), reach.end()) * lanes.unit.length;
    engine.near_step = static_cast<std::int64_t>(s.state.step);
    for_each_block_of_groups(s, lanes, [&](std::size_t, std::size_t begin, std::size_t end) { pick_near(lanes, edge, begin, end); });
  });
}

void rearrange_lanes(LaneEngine& engine, Stepping& s) {
  with_lanes(engine, [&](auto& lanes) {
    take_rows_of(s, lanes);
    const double length = lanes.unit.length;
    arrange(lanes, edges(s.state.packing.H, lanes.unit), s.skin / length, left_for_near(s) / length, *s.team);
    refresh_rows(s, lanes);
  });
  engine.near_step = -1;
  repick_near(engine, s);
}

void read_lanes(LaneEngine& engine, Stepping& s) {
  with_lanes(engine, [&](auto& lanes) {
    take_rows_of(s, lanes);
    store_lanes(lanes, s.state);
    s.state.sums.E_pot = 0.25 * s.state.material.stiffness * sum_squared_overlaps(lanes, s.state.packing.H);
  });
}

std::vector<Row> predicted_velocities(const LaneEngine& engine) {
  return with_lanes(engine, [](const auto& lanes) {
    const double speed = lanes.unit.length / lanes.unit.time;
    std::vector<Row> velocity(lanes.spheres);
    for (std::size_t t = 0; t < lanes.spheres; ++t) {
      const auto& row = lanes.row[t];
      velocity[lanes.listed[t / kLanes].sphere[t % kLanes]] = {row.vx * speed, row.vy * speed, row.vz * speed, 0};
    }
    return velocity;
  });
}

NeighbourList list_of(const LaneEngine& engine, const Packing& packing, Listed which) {
  return with_lanes(engine, [&](const auto& lanes) { return plain_list(lanes, packing, which); });
}

}  // namespace grainlaw::dem
