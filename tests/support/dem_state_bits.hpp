#pragma once
// States compared bit by bit, and a packing whose motion would show any difference soon.

#include <bit>
#include <cstdint>
#include <vector>

#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem::scene {

/// Every bit that the state's future depends on.
inline std::vector<std::uint64_t> bits_of(const State& state) {
  std::vector<std::uint64_t> bits;
  const Packing& p = state.packing;
  const auto add = [&](double x) { bits.push_back(std::bit_cast<std::uint64_t>(x)); };
  for (const std::int64_t id : p.id) bits.push_back(static_cast<std::uint64_t>(id));
  for (const auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz, &state.ax, &state.ay, &state.az,
                        &state.ref_x, &state.ref_y, &state.ref_z}) {
    bits.push_back(a->size());
    for (const double x : *a) add(x);
  }
  const Ledger& l = state.ledger;
  const PassSums& s = state.sums;
  const Material& m = state.material;
  for (const double x :
       {l.W_box, l.D_contact, l.D_background, l.E_start, l.E_kin_start, s.box_power, s.contact_power, s.E_pot,
        s.drag_power, state.time, m.density, m.stiffness, m.contact_viscosity, m.background_viscosity}) {
    add(x);
  }
  for (const double x : p.H.reshaped()) add(x);
  for (const double x : state.ref_H.reshaped()) add(x);
  bits.push_back(state.step);
  bits.push_back(state.seed);
  return bits;
}

/// A dense packing that bursts: deep overlaps, many contacts made and lost, many rebuilds of the list.
inline State bursting_packing(std::size_t n) {
  Draw draw(61);
  State state = random_state(n, 3, 0.7, Eigen::Matrix3d::Identity(), draw);
  random_velocities(state.packing, 2, draw);
  return state;
}

}  // namespace grainlaw::dem::scene
