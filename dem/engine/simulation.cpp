#include "dem/engine/simulation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dem/engine/energy_account.hpp"
#include "dem/engine/lanes/lane_engine.hpp"
#include "dem/engine/lanes/lane_list.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kSmallestSkin = 0.05;  // of lanes in small cells, over the mean radius

std::pair<std::size_t, std::size_t> block_range(std::size_t block, std::size_t n) {
  return {block * kBlockSize, std::min(n, (block + 1) * kBlockSize)};
}

/// Position with radius, from the fractions and the cell.
Row place_of(const Packing& p, std::size_t i) {
  const Eigen::Matrix3d& H = p.H;
  const double sx = p.sx[i], sy = p.sy[i], sz = p.sz[i];
  return {H(0, 0) * sx + H(0, 1) * sy + H(0, 2) * sz, H(1, 1) * sy + H(1, 2) * sz, H(2, 2) * sz, p.radius[i]};
}

void place_spheres(Simulation& sim, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) sim.place[i] = place_of(sim.state.packing, i);
}

/// H n [m] of each image of the list.
std::vector<Eigen::Vector3d> image_shifts(const Eigen::Matrix3d& H, const NeighbourList& list) {
  std::vector<Eigen::Vector3d> shift;
  for (const Eigen::Vector3d& n : list.offset) shift.push_back(H * n);
  return shift;
}

/// What sums over the contacts of `sim` read, off lanes; `sim` and `shift` must outlive it.
ForceField force_field(const Simulation& sim, const CellMotion& motion, const std::vector<Eigen::Vector3d>& shift) {
  const Packing& p = sim.state.packing;
  const Material& material = sim.state.material;
  return {&sim.list,   sim.place.data(), sim.motion.data(),  p.sx.data(),                p.sy.data(),
          p.sz.data(), shift.data(),     p.id.data(),        p.H,                        motion.L,
          material.stiffness, material.contact_viscosity,    motion.transport == Transport::wall};
}

/// Skin of a list made in the cell H [m]: as asked for, but in small cells what lanes still fit with.
double list_skin(const Simulation& sim, const Eigen::Matrix3d& H) {
  const double r = mean_radius(sim.state.packing), asked = sim.options.skin * r;
  const double fitting = 0.49 * H.diagonal().minCoeff() - 2 * sim.list.r_max;
  return sim.options.precision != Precision::reference && fitting > kSmallestSkin * r ? std::min(asked, fitting) : asked;
}

void remember_reference(State& state) {
  wrap(state.packing);
  state.ref_x = state.packing.sx;
  state.ref_y = state.packing.sy;
  state.ref_z = state.packing.sz;
  state.ref_H = state.packing.H;
}

/// New list at the current positions, remembered as the reference.
void rebuild(Simulation& sim) {
  Packing& p = sim.state.packing;
  remember_reference(sim.state);
  sim.list = build_list(p, sim.list.skin, *sim.team);
  sim.team->for_each_block(block_count(p.size()), [&](std::size_t block) {
    const auto [begin, end] = block_range(block, p.size());
    place_spheres(sim, begin, end);
  });
}

/// The list as it was at the reference of a continued run.
void restore_list(Simulation& sim) {
  Packing reference = sim.state.packing;
  reference.sx = sim.state.ref_x;
  reference.sy = sim.state.ref_y;
  reference.sz = sim.state.ref_z;
  reference.H = sim.state.ref_H;
  sim.list = build_list(reference, sim.list.skin, *sim.team);
}

/// Runs the force pass block by block. When the forces of a block are known, after(begin, end) brings its velocities to
/// the end of the step; then the powers are taken that need both.
template <class After>
PassSums force_pass(Simulation& sim, const CellMotion& motion, const After& after) {
  const Packing& p = sim.state.packing;
  const std::vector<Eigen::Vector3d> shift = image_shifts(sim.state.packing.H, sim.list);
  const ForceField field = force_field(sim, motion, shift);
  std::vector<PassSums> parts(block_count(p.size()));
  sim.team->for_each_block(parts.size(), [&](std::size_t block) {
    const auto [begin, end] = block_range(block, p.size());
    PassSums& part = parts[block] = contact_forces(field, begin, end, sim.force.data(), sim.viscous.data());
    after(begin, end);
    double lost = 0, v2 = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Row& F_v = sim.viscous[i];
      lost -= F_v[0] * p.vx[i] + F_v[1] * p.vy[i] + F_v[2] * p.vz[i];
      v2 += p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
    }
    part.contact_power += lost;
    part.drag_power = sim.state.material.background_viscosity * v2;
  });
  PassSums sums;
  for (const PassSums& part : parts) {
    sums.box_power += part.box_power;
    sums.contact_power += part.contact_power;
    sums.E_pot += part.E_pot;
    sums.drag_power += part.drag_power;
  }
  return sums;
}

void first_forces(Simulation& sim, const CellMotion& motion) {
  State& state = sim.state;
  Packing& p = state.packing;
  for (std::size_t i = 0; i < p.size(); ++i) sim.motion[i] = {p.vx[i], p.vy[i], p.vz[i], 0};
  for (auto* a : {&state.ax, &state.ay, &state.az}) a->assign(p.size(), 0.0);
  const double gamma_b = state.material.background_viscosity;
  state.sums = force_pass(sim, motion, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      state.ax[i] = (sim.force[i][0] - gamma_b * p.vx[i]) / p.mass[i];
      state.ay[i] = (sim.force[i][1] - gamma_b * p.vy[i]) / p.mass[i];
      state.az[i] = (sim.force[i][2] - gamma_b * p.vz[i]) / p.mass[i];
    }
  });
}

/// Refuses a sphere that would be thrown out of another one. Deep overlaps in equilibrium, of a tiny sphere caught
/// between large ones, may stay.
void refuse_deep_overlaps(const Simulation& sim, const CellMotion& motion) {
  const Packing& p = sim.state.packing;
  const std::vector<Eigen::Vector3d> shift = image_shifts(sim.state.packing.H, sim.list);
  const ForceField field = force_field(sim, motion, shift);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Row &f = sim.force[i], &f_v = sim.viscous[i];
    const double net = std::hypot(f[0] - f_v[0], f[1] - f_v[1], f[2] - f_v[2]);  // of the elastic forces
    visit_contacts<false>(field, i, [&](const Contact& c) {
      if (p.radius[c.j] < p.radius[i] || c.delta <= p.radius[i] || net <= 0.5 * field.stiffness * c.delta) return;
      throw InvalidInput(fmt::format(
          "spheres {} and {} overlap by {:.3g} m, more than the smaller radius, and nothing holds them; move one of them",
          p.id[i], p.id[c.j], c.delta));
    });
  }
}

/// First half of a step for the spheres of a block: half kick, drift, prediction of the velocity. Returns the largest
/// squared distance that one of them has moved against the cell since the rebuild of the list.
double kick_and_drift(Simulation& sim, const CellMotion& half, const Eigen::Matrix3d& drift, const Eigen::Matrix3d& carry,
                      std::size_t begin, std::size_t end) {
  State& state = sim.state;
  Packing& p = state.packing;
  const Eigen::Matrix3d& H = p.H;  // already the cell at the end of the step
  const double h = sim.dt / 2;
  double moved2 = 0;
  for (std::size_t i = begin; i < end; ++i) {
    p.vx[i] += h * state.ax[i];
    p.vy[i] += h * state.ay[i];
    p.vz[i] += h * state.az[i];
    const double vx = p.vx[i], vy = p.vy[i], vz = p.vz[i];
    if (half.transport == Transport::wall) {
      const Eigen::Vector3d image(std::floor(p.sx[i]), std::floor(p.sy[i]), std::floor(p.sz[i]));
      const Eigen::Vector3d inside = carry * (Eigen::Vector3d(p.sx[i], p.sy[i], p.sz[i]) - image) + image;
      p.sx[i] = inside[0];
      p.sy[i] = inside[1];
      p.sz[i] = inside[2];
    }
    p.sx[i] += drift(0, 0) * vx + drift(0, 1) * vy + drift(0, 2) * vz;
    p.sy[i] += drift(1, 1) * vy + drift(1, 2) * vz;
    p.sz[i] += drift(2, 2) * vz;
    sim.motion[i] = {vx + h * state.ax[i], vy + h * state.ay[i], vz + h * state.az[i], 0};
    const double ux = p.sx[i] - state.ref_x[i], uy = p.sy[i] - state.ref_y[i], uz = p.sz[i] - state.ref_z[i];
    const double x = H(0, 0) * ux + H(0, 1) * uy + H(0, 2) * uz, y = H(1, 1) * uy + H(1, 2) * uz, z = H(2, 2) * uz;
    const double d2 = x * x + y * y + z * z;
    if (!(d2 <= moved2)) moved2 = d2;  // a NaN stays
    if (std::isnan(d2)) return d2;
  }
  return moved2;
}

/// The first half of a step for all spheres.
Drifted drift(Simulation& sim, const Eigen::Matrix3d& start_H, const CellMotion& half, const CellMotion& end) {
  const std::size_t n = sim.state.packing.size();
  const Eigen::Matrix3d drift = sim.dt * (half.transport == Transport::wall ? end.H : half.H).inverse();
  const Eigen::Matrix3d carry = end.H.inverse() * start_H;
  std::vector<double> moved2(block_count(n));
  sim.team->for_each_block(moved2.size(), [&](std::size_t block) {
    const auto [first, last] = block_range(block, n);
    moved2[block] = kick_and_drift(sim, half, drift, carry, first, last);
    place_spheres(sim, first, last);
  });
  double farthest2 = 0;
  for (const double d2 : moved2) {
    if (!(d2 < std::numeric_limits<double>::infinity())) return Drifted::lost;
    farthest2 = std::max(farthest2, d2);
  }
  if (n == 0) return Drifted::well;
  const double allowed = allowed_displacement(sim.list, sim.state.ref_H, end.H);
  return std::sqrt(farthest2) < allowed ? Drifted::well : Drifted::beyond_list;
}

bool on_lanes(const Simulation& sim) { return !std::holds_alternative<std::monostate>(sim.lanes); }

/// Goes on with the state itself and the list of its last rebuild.
void leave_lanes(Simulation& sim) {
  synchronise(sim);
  sim.lanes = {};
  restore_list(sim);
}

/// New list in the middle of a step; it decides, too, whether the simulation goes on on lanes.
void renew_list(Simulation& sim, const CellMotion& end) {
  State& state = sim.state;
  ++sim.rebuilds;
  sim.list.skin = list_skin(sim, end.H);
  const bool suitable = suits_lanes(sim, end);
  if (on_lanes(sim) && suitable) {
    state.ref_H = state.packing.H;
    rearrange_lanes(sim);
  } else if (suitable) {
    remember_reference(state);
    enter_lanes(sim);
  } else {
    if (on_lanes(sim)) {
      read_lanes(sim);
      read_predicted(sim);
      sim.lanes = {};
    }
    rebuild(sim);
  }
}

/// Second half: kick with the new force, drag treated implicitly.
void kick(Simulation& sim, std::size_t begin, std::size_t end) {
  State& state = sim.state;
  Packing& p = state.packing;
  const double h = sim.dt / 2, gamma_b = state.material.background_viscosity;
  for (std::size_t i = begin; i < end; ++i) {
    const double inverse_mass = 1 / p.mass[i];
    const double damped = 1 / (1 + h * gamma_b * inverse_mass);
    p.vx[i] = (p.vx[i] + h * sim.force[i][0] * inverse_mass) * damped;
    p.vy[i] = (p.vy[i] + h * sim.force[i][1] * inverse_mass) * damped;
    p.vz[i] = (p.vz[i] + h * sim.force[i][2] * inverse_mass) * damped;
    state.ax[i] = (sim.force[i][0] - gamma_b * p.vx[i]) * inverse_mass;
    state.ay[i] = (sim.force[i][1] - gamma_b * p.vy[i]) * inverse_mass;
    state.az[i] = (sim.force[i][2] - gamma_b * p.vz[i]) * inverse_mass;
  }
}

/// Of a sphere that is nowhere, or that one step would carry farther than any sound one could.
[[noreturn]] void report_lost_sphere(const Packing& p, double dt) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const bool finite = std::isfinite(p.sx[i] + p.sy[i] + p.sz[i] + p.vx[i] + p.vy[i] + p.vz[i]);
    const double edges = dt * (std::abs(p.vx[i]) / p.H(0, 0) + std::abs(p.vy[i]) / p.H(1, 1) + std::abs(p.vz[i]) / p.H(2, 2));
    if (!finite || edges > 0.124) {
      throw Error(fmt::format("energy balance: sphere {}: {}; use a smaller time_step_fraction", p.id[i],
                              finite ? "crosses more than an eighth of the cell in one step"
                                     : "position or velocity is no longer finite"));
    }
  }
  throw Error("energy balance: a sphere moved farther in one step than numbers can hold; use a smaller time_step_fraction");
}

}  // namespace

Simulation start_simulation(State state, const EngineOptions& options, const CellMotion& motion) {
  Simulation sim;
  sim.options = options;
  sim.state = std::move(state);
  Packing& p = sim.state.packing;
  p.H = motion.H;
  check(p);
  if (options.precision == Precision::mixed) round_radii(p);
  sim.team = std::make_shared<ThreadTeam>(options.threads);
  const std::size_t n = p.size();
  sim.place.resize(n);
  sim.motion.resize(n);
  sim.force.resize(n);
  sim.viscous.resize(n);
  const bool continued = sim.state.ax.size() == n && sim.state.ref_x.size() == n && n > 0;
  if (n > 0) {
    sim.dt = options.time_step_fraction * min_collision_time(p, sim.state.material);
    if (!(sim.dt > 0) || !std::isfinite(sim.dt)) {
      throw InvalidInput(
          "time_step_fraction: the time step is not positive and finite; check it, stiffness and contact_viscosity "
          "(an overdamped contact has no collision time)");
    }
    if (!(options.skin > 0) || !std::isfinite(options.skin)) throw InvalidInput("skin: must be positive and finite");
    sim.list.r_max = *std::max_element(p.radius.begin(), p.radius.end());
    sim.list.skin = list_skin(sim, continued ? sim.state.ref_H : p.H);
  }
  if (continued && suits_lanes(sim, {sim.state.ref_H, motion.L, motion.transport})) {
    enter_lanes(sim);
  } else if (continued) {
    restore_list(sim);
    sim.team->for_each_block(block_count(n), [&](std::size_t block) {
      const auto [begin, end] = block_range(block, n);
      place_spheres(sim, begin, end);
    });
  } else {
    ++sim.rebuilds;
    rebuild(sim);
    first_forces(sim, motion);
    if (options.refuse_deep_overlaps) refuse_deep_overlaps(sim, motion);
    if (suits_lanes(sim, motion)) {
      enter_lanes(sim);
      synchronise(sim);  // positions and energy as the lanes have them
    }
  }
  return sim;
}

void advance(Simulation& sim, const CellMotion& half, const CellMotion& end) {
  State& state = sim.state;
  if (on_lanes(sim) && !moves_as_lanes_do(half)) leave_lanes(sim);
  const Eigen::Matrix3d start_H = std::exchange(state.packing.H, end.H);
  Drifted how;
  if (sim.unkicked) {
    const KickAndDrift done = kick_and_drift_lanes(sim, *std::exchange(sim.unkicked, {}), half);
    account(sim, done.sums);
    how = done.how;
  } else {
    how = on_lanes(sim) ? drift_lanes(sim, half) : drift(sim, start_H, half, end);
  }
  if (how == Drifted::lost) {
    synchronise(sim);
    report_lost_sphere(state.packing, sim.dt);
  }
  if (how == Drifted::beyond_near && !list_still_holds(sim)) how = Drifted::beyond_list;
  if (how == Drifted::beyond_near) repick_near(sim);
  if (how == Drifted::beyond_list) renew_list(sim, end);

  if (on_lanes(sim)) {
    sim.unkicked = end;
  } else {
    account(sim, force_pass(sim, end, [&](std::size_t first, std::size_t last) { kick(sim, first, last); }));
  }
  ++state.step;
  state.time += sim.dt;
}

void synchronise(Simulation& sim) {
  if (!on_lanes(sim)) return;
  if (sim.unkicked) account(sim, kick_lanes(sim, *std::exchange(sim.unkicked, {})));
  read_lanes(sim);
}

std::unique_ptr<ContactView> view_contacts(const Simulation& sim, const CellMotion& motion) {
  const Packing& p = sim.state.packing;
  auto view = std::make_unique<ContactView>();
  if (const auto* mixed = std::get_if<Lanes<float>>(&sim.lanes)) {
    view->list = plain_list(*mixed, p, Listed::near);
  } else if (const auto* full = std::get_if<Lanes<double>>(&sim.lanes)) {
    view->list = plain_list(*full, p, Listed::near);
  } else {
    view->list = sim.list;
  }
  view->shift = image_shifts(p.H, view->list);
  view->place.resize(p.size());
  view->motion.resize(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    view->place[i] = place_of(p, i);
    view->motion[i] = {p.vx[i], p.vy[i], p.vz[i], 0};
  }
  view->field = force_field(sim, motion, view->shift);
  view->field.list = &view->list;
  view->field.place = view->place.data();
  view->field.motion = view->motion.data();
  return view;
}

}  // namespace grainlaw::dem
