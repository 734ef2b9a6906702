#include "dem/engine/plain_engine.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

std::pair<std::size_t, std::size_t> block_range(std::size_t block, std::size_t n) {
  return {block * kBlockSize, std::min(n, (block + 1) * kBlockSize)};
}

void place_spheres(PlainEngine& engine, const Packing& p, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) engine.place[i] = place_with_radius(p, i);
}

void place_all(PlainEngine& engine, const Stepping& s) {
  const Packing& p = s.state.packing;
  s.team->for_each_block(block_count(p.size()), [&](std::size_t block) {
    const auto [begin, end] = block_range(block, p.size());
    place_spheres(engine, p, begin, end);
  });
}

PlainEngine sized(std::size_t n) {
  PlainEngine engine;
  for (auto* rows : {&engine.place, &engine.motion, &engine.force, &engine.viscous}) rows->resize(n);
  return engine;
}

/// Forces on the spheres [begin, end) into force[i] = {fx, fy, fz, unused}, their viscous parts likewise into viscous[i];
/// returns their share of the totals, of the power lost in contacts only the part of the cell's motion.
template <bool wall_driven>
PassSums contact_forces(const ForceField& field, std::size_t begin, std::size_t end, Row* force, Row* viscous) {
  PassSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    double fx = 0, fy = 0, fz = 0, gx = 0, gy = 0, gz = 0, box = 0, lost = 0, elastic = 0;
    visit_contacts<wall_driven>(field, i, [&](const Contact& c) {
      fx += c.force * c.nx;
      fy += c.force * c.ny;
      fz += c.force * c.nz;
      box -= c.force * c.u_n;
      const double g = field.viscosity * c.rate;
      gx += g * c.nx;
      gy += g * c.ny;
      gz += g * c.nz;
      lost -= g * c.u_n;
      elastic += c.delta * c.delta;
    });
    force[i] = {fx, fy, fz, 0};
    viscous[i] = {gx, gy, gz, 0};
    sums.box_power += 0.5 * box;
    sums.contact_power += 0.5 * lost;
    sums.E_pot += 0.25 * field.stiffness * elastic;
  }
  return sums;
}

/// Runs the force pass block by block. When the forces of a block are known, after(begin, end) brings its velocities to
/// the end of the step; then the powers are taken that need both.
template <class After>
PassSums force_pass(PlainEngine& engine, const Stepping& s, const CellMotion& motion, const After& after) {
  const Packing& p = s.state.packing;
  const std::vector<Eigen::Vector3d> shift = image_shifts(p.H, engine.list);
  const ForceField field = force_field(s.state, motion, engine.list, engine.place, engine.motion, shift);
  std::vector<PassSums> parts(block_count(p.size()));
  s.team->for_each_block(parts.size(), [&](std::size_t block) {
    const auto [begin, end] = block_range(block, p.size());
    PassSums& part = parts[block] =
        field.wall_driven ? contact_forces<true>(field, begin, end, engine.force.data(), engine.viscous.data())
                          : contact_forces<false>(field, begin, end, engine.force.data(), engine.viscous.data());
    after(begin, end);
    double lost = 0, v2 = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Row& F_v = engine.viscous[i];
      lost -= F_v[0] * p.vx[i] + F_v[1] * p.vy[i] + F_v[2] * p.vz[i];
      v2 += p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
    }
    part.contact_power += lost;
    part.drag_power = s.state.material.background_viscosity * v2;
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

/// First half of a step for the spheres of a block: half kick, drift, prediction of the velocity. Returns the largest
/// squared distance that one of them has moved against the cell since the rebuild of the list.
double kick_and_drift(PlainEngine& engine, Stepping& s, const CellMotion& half, const Eigen::Matrix3d& drift,
                      const Eigen::Matrix3d& carry, std::size_t begin, std::size_t end) {
  State& state = s.state;
  Packing& p = state.packing;
  const Eigen::Matrix3d& H = p.H;  // already the cell at the end of the step
  const double h = s.dt / 2;
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
    engine.motion[i] = {vx + h * state.ax[i], vy + h * state.ay[i], vz + h * state.az[i], 0};
    const double ux = p.sx[i] - state.ref_x[i], uy = p.sy[i] - state.ref_y[i], uz = p.sz[i] - state.ref_z[i];
    const double x = H(0, 0) * ux + H(0, 1) * uy + H(0, 2) * uz, y = H(1, 1) * uy + H(1, 2) * uz, z = H(2, 2) * uz;
    const double d2 = x * x + y * y + z * z;
    if (!(d2 <= moved2)) moved2 = d2;  // a NaN stays
    if (std::isnan(d2)) return d2;
  }
  return moved2;
}

void kick_block(const PlainEngine& engine, Stepping& s, std::size_t begin, std::size_t end) {
  State& state = s.state;
  Packing& p = state.packing;
  const double h = s.dt / 2, gamma_b = state.material.background_viscosity;
  for (std::size_t i = begin; i < end; ++i) {
    const double inverse_mass = 1 / p.mass[i];
    const double damped = 1 / (1 + h * gamma_b * inverse_mass);
    p.vx[i] = (p.vx[i] + h * engine.force[i][0] * inverse_mass) * damped;
    p.vy[i] = (p.vy[i] + h * engine.force[i][1] * inverse_mass) * damped;
    p.vz[i] = (p.vz[i] + h * engine.force[i][2] * inverse_mass) * damped;
    state.ax[i] = (engine.force[i][0] - gamma_b * p.vx[i]) * inverse_mass;
    state.ay[i] = (engine.force[i][1] - gamma_b * p.vy[i]) * inverse_mass;
    state.az[i] = (engine.force[i][2] - gamma_b * p.vz[i]) * inverse_mass;
  }
}

}  // namespace

void remember_reference(State& state) {
  wrap(state.packing);
  state.ref_x = state.packing.sx;
  state.ref_y = state.packing.sy;
  state.ref_z = state.packing.sz;
  state.ref_H = state.packing.H;
}

PlainEngine start_plain(Stepping& s) {
  PlainEngine engine = sized(s.state.packing.size());
  rebuild(engine, s);
  return engine;
}

PlainEngine continue_plain(Stepping& s) {
  PlainEngine engine = sized(s.state.packing.size());
  Packing reference = s.state.packing;
  reference.sx = s.state.ref_x;
  reference.sy = s.state.ref_y;
  reference.sz = s.state.ref_z;
  reference.H = s.state.ref_H;
  engine.list = build_list(reference, s.skin, *s.team);
  place_all(engine, s);
  return engine;
}

void rebuild(PlainEngine& engine, Stepping& s) {
  remember_reference(s.state);
  engine.list = build_list(s.state.packing, s.skin, *s.team);
  place_all(engine, s);
}

void first_forces(PlainEngine& engine, Stepping& s, const CellMotion& motion) {
  State& state = s.state;
  Packing& p = state.packing;
  for (std::size_t i = 0; i < p.size(); ++i) engine.motion[i] = {p.vx[i], p.vy[i], p.vz[i], 0};
  for (auto* a : {&state.ax, &state.ay, &state.az}) a->assign(p.size(), 0.0);
  const double gamma_b = state.material.background_viscosity;
  state.sums = force_pass(engine, s, motion, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      state.ax[i] = (engine.force[i][0] - gamma_b * p.vx[i]) / p.mass[i];
      state.ay[i] = (engine.force[i][1] - gamma_b * p.vy[i]) / p.mass[i];
      state.az[i] = (engine.force[i][2] - gamma_b * p.vz[i]) / p.mass[i];
    }
  });
}

void refuse_deep_overlaps(const PlainEngine& engine, const Stepping& s, const CellMotion& motion) {
  const Packing& p = s.state.packing;
  const std::vector<Eigen::Vector3d> shift = image_shifts(p.H, engine.list);
  const ForceField field = force_field(s.state, motion, engine.list, engine.place, engine.motion, shift);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Row &f = engine.force[i], &f_v = engine.viscous[i];
    const double net = std::hypot(f[0] - f_v[0], f[1] - f_v[1], f[2] - f_v[2]);  // of the elastic forces
    visit_contacts<false>(field, i, [&](const Contact& c) {
      if (p.radius[c.j] < p.radius[i] || c.delta <= p.radius[i] || net <= 0.5 * field.stiffness * c.delta) return;
      throw InvalidInput(
          fmt::format("spheres {} and {} overlap by {:.3g} m, more than the smaller radius, and nothing holds them; "
                      "move one of them",
                      p.id[i], p.id[c.j], c.delta));
    });
  }
}

Drifted drift(PlainEngine& engine, Stepping& s, const Eigen::Matrix3d& start_H, const CellMotion& half,
              const CellMotion& end) {
  const std::size_t n = s.state.packing.size();
  const Eigen::Matrix3d drift = s.dt * (half.transport == Transport::wall ? end.H : half.H).inverse();
  const Eigen::Matrix3d carry = end.H.inverse() * start_H;
  std::vector<double> moved2(block_count(n));
  s.team->for_each_block(moved2.size(), [&](std::size_t block) {
    const auto [first, last] = block_range(block, n);
    moved2[block] = kick_and_drift(engine, s, half, drift, carry, first, last);
    place_spheres(engine, s.state.packing, first, last);
  });
  double farthest2 = 0;
  for (const double d2 : moved2) {
    if (!(d2 < std::numeric_limits<double>::infinity())) return Drifted::lost;
    farthest2 = std::max(farthest2, d2);
  }
  if (n == 0) return Drifted::well;
  const double allowed = allowed_displacement(engine.list, s.state.ref_H, end.H);
  return std::sqrt(farthest2) < allowed ? Drifted::well : Drifted::beyond_list;
}

PassSums kick(PlainEngine& engine, Stepping& s, const CellMotion& end) {
  return force_pass(engine, s, end, [&](std::size_t first, std::size_t last) { kick_block(engine, s, first, last); });
}

}  // namespace grainlaw::dem
