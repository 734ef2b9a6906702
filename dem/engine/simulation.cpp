#include "dem/engine/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dem/engine/state.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kSmallestSkin = 0.05;  // of lanes in small cells, over the mean radius

/// Skin of a list made in the cell H [m]: as asked for, but in small cells what lanes still fit with.
double list_skin(const Stepping& s, const Eigen::Matrix3d& H) {
  const double r = mean_radius(s.state.packing), asked = s.options.skin * r;
  const double fitting = 0.49 * H.diagonal().minCoeff() - 2 * s.r_max;
  return s.options.precision != Precision::reference && fitting > kSmallestSkin * r ? std::min(asked, fitting) : asked;
}

// The stiffest mode of a packing over that of its lightest pair. For w = 3 steps of 0.48 t_c are stable and such of 0.56 not,
// which makes it 1.0 ... 1.3.
constexpr double kStiffestMode = 1.5;

/// Time step, largest radius and skin.
void choose_scales(Stepping& s, const Eigen::Matrix3d& list_H) {
  s.dt = s.options.time_step_fraction * min_collision_time(s.state.packing, s.state.material);
  if (!(s.dt > 0) || !std::isfinite(s.dt)) {
    throw InvalidInput(
        "time_step_fraction: the time step is not positive and finite; check it, stiffness and contact_viscosity "
        "(an overdamped contact has no collision time)");
  }
  if (!(s.options.skin > 0) || !std::isfinite(s.options.skin)) throw InvalidInput("skin: must be positive and finite");
  const std::vector<double>& radius = s.state.packing.radius;
  s.r_max = *std::max_element(radius.begin(), radius.end());
  s.skin = list_skin(s, list_H);
}

/// Of a sphere that is nowhere, or that one step would carry farther than any sound one could.
[[noreturn]] void report_lost_sphere(const Packing& p, double dt) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const bool finite = std::isfinite(p.sx[i] + p.sy[i] + p.sz[i] + p.vx[i] + p.vy[i] + p.vz[i]);
    const double edges =
        dt * (std::abs(p.vx[i]) / p.H(0, 0) + std::abs(p.vy[i]) / p.H(1, 1) + std::abs(p.vz[i]) / p.H(2, 2));
    if (!finite || edges > 0.124) {
      throw Error(fmt::format(
          "energy balance: sphere {}: {}; use a smaller time_step_fraction", p.id[i],
          finite ? "crosses more than an eighth of the cell in one step" : "position or velocity is no longer finite"));
    }
  }
  throw Error(
      "energy balance: a sphere moved farther in one step than numbers can hold; use a smaller time_step_fraction");
}

}  // namespace

void check_time_step(double fraction, const Material& material, double lightest_pair) {
  if (!(fraction > 0) || !std::isfinite(fraction))
    throw InvalidInput(fmt::format("time_step_fraction: {} must be positive and finite", fraction));
  if (fraction > kMaxTimeStepFraction) {
    throw InvalidInput(
        fmt::format("time_step_fraction: {} is beyond {}, where the integration becomes unstable; give a smaller one",
                    fraction, kMaxTimeStepFraction));
  }
  const double largest =
      stable_time_step(material, lightest_pair / kStiffestMode) / collision_time(material, lightest_pair);
  if (!(fraction > largest)) return;  // an overdamped contact has no collision time; the simulation refuses it
  throw InvalidInput(fmt::format(
      "time_step_fraction: {} is unstable with this contact_viscosity: at {:.3g} of the critical damping of the "
      "smallest "
      "spheres a collision takes long, but damping wants short steps; give at most {:.3g}, or less contact_viscosity",
      fraction, damping_ratio(material, lightest_pair), 0.99 * largest));
}

Simulation::Simulation(State state, const EngineOptions& options, const CellMotion& motion) {
  Stepping& s = stepping_;
  s.options = options;
  s.state = std::move(state);
  Packing& p = s.state.packing;
  p.H = motion.H;
  check(p);
  check(s.state.material);
  check_sizes(p);
  if (!motion.L.allFinite()) throw InvalidInput("cell: its velocity gradient must be finite");
  if (options.precision == Precision::mixed) round_radii(p);
  s.team = std::make_shared<ThreadTeam>(options.threads);
  const bool continued = s.state.ax.size() == p.size() && s.state.ref_x.size() == p.size() && p.size() > 0;
  if (p.size() > 0) choose_scales(s, continued ? s.state.ref_H : p.H);
  if (continued && suits_lanes(s, {s.state.ref_H, motion.L, motion.transport})) {
    engine_ = enter_lanes(s);
    current_ = false;  // to the last bit only if it was on such lanes before
  } else if (continued) {
    engine_ = continue_plain(s);
  } else {
    ++s.rebuilds;
    PlainEngine& plain = engine_.emplace<PlainEngine>(start_plain(s));
    first_forces(plain, s, motion);
    if (options.refuse_deep_overlaps) refuse_deep_overlaps(plain, s, motion);
    if (suits_lanes(s, motion)) {
      engine_ = enter_lanes(s);
      current_ = false;  // positions and energy are now as the lanes have them
      bring_up_to_date();
    }
  }
}

void Simulation::advance(const CellMotion& half, const CellMotion& end) {
  State& state = stepping_.state;
  if (lanes() && !moves_as_lanes_do(half)) {
    bring_up_to_date();
    engine_ = continue_plain(stepping_);
  }
  const Eigen::Matrix3d start_H = std::exchange(state.packing.H, end.H);
  current_ = false;
  const Drifted how = first_half(start_H, half, end);
  if (how == Drifted::lost) {
    bring_up_to_date();
    report_lost_sphere(state.packing, stepping_.dt);
  }
  LaneEngine* on_lanes = std::get_if<LaneEngine>(&engine_);
  if (how == Drifted::beyond_near && list_still_holds(*on_lanes, stepping_)) {
    repick_near(*on_lanes, stepping_);
  } else if (how != Drifted::well) {
    renew_list(end);
  }
  if (LaneEngine* engine = std::get_if<LaneEngine>(&engine_)) {
    engine->unkicked = end;
  } else {
    account(state, stepping_.dt, kick(std::get<PlainEngine>(engine_), stepping_, end));
    current_ = true;
  }
  ++state.step;
  state.time += stepping_.dt;
}

Drifted Simulation::first_half(const Eigen::Matrix3d& start_H, const CellMotion& half, const CellMotion& end) {
  if (LaneEngine* engine = std::get_if<LaneEngine>(&engine_)) return drift(*engine, stepping_, half);
  return drift(std::get<PlainEngine>(engine_), stepping_, start_H, half, end);
}

/// New list in the middle of a step; it decides, too, which engine goes on.
void Simulation::renew_list(const CellMotion& end) {
  ++stepping_.rebuilds;
  stepping_.skin = list_skin(stepping_, end.H);
  const bool suitable = suits_lanes(stepping_, end);
  LaneEngine* on_lanes = std::get_if<LaneEngine>(&engine_);
  if (on_lanes && suitable) {
    stepping_.state.ref_H = stepping_.state.packing.H;
    rearrange_lanes(*on_lanes, stepping_);
  } else if (suitable) {
    remember_reference(stepping_.state);
    engine_ = enter_lanes(stepping_);
  } else if (on_lanes) {
    read_lanes(*on_lanes, stepping_);
    std::vector<Row> predicted = predicted_velocities(*on_lanes);
    engine_.emplace<PlainEngine>(start_plain(stepping_)).motion = std::move(predicted);
  } else {
    rebuild(std::get<PlainEngine>(engine_), stepping_);
  }
}

void Simulation::bring_up_to_date() {
  LaneEngine* engine = std::get_if<LaneEngine>(&engine_);
  if (engine && !current_) {
    end_step(*engine, stepping_);
    read_lanes(*engine, stepping_);
  }
  current_ = true;
}

const State& Simulation::state() {
  bring_up_to_date();
  return stepping_.state;
}

State Simulation::take_state() {
  bring_up_to_date();
  return std::move(stepping_.state);
}

void Simulation::open_ledger() {
  bring_up_to_date();
  dem::open_ledger(stepping_.state);
}

void Simulation::set_dt(double dt) {
  bring_up_to_date();
  stepping_.dt = dt;
}

NeighbourList Simulation::neighbours(Listed which) {
  bring_up_to_date();
  if (const LaneEngine* engine = lanes()) return list_of(*engine, stepping_.state.packing, which);
  return plain()->list;
}

std::unique_ptr<ContactView> view_contacts(Simulation& sim, const CellMotion& motion) {
  return view_contacts(sim.state(), sim.neighbours(Listed::near), motion);
}

}  // namespace grainlaw::dem
