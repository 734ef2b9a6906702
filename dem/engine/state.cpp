#include "dem/engine/state.hpp"

#include <cmath>

namespace grainlaw::dem {

State tiled(const State& one, int tiles) {
  const auto t = static_cast<std::size_t>(tiles);
  const Packing& p = one.packing;
  State all;
  all.material = one.material;
  Packing& q = all.packing;
  resize(q, p.size() * t * t * t);
  q.H = p.H * tiles;
  const auto place = [&](double s, std::size_t tile) {
    return (s - std::floor(s) + static_cast<double>(tile)) / tiles;
  };
  for (std::size_t copy = 0, to = 0; copy < t * t * t; ++copy) {
    for (std::size_t i = 0; i < p.size(); ++i, ++to) {
      q.radius[to] = p.radius[i];
      q.mass[to] = p.mass[i];
      q.sx[to] = place(p.sx[i], copy % t);
      q.sy[to] = place(p.sy[i], copy / t % t);
      q.sz[to] = place(p.sz[i], copy / t / t);
      q.vx[to] = p.vx[i];
      q.vy[to] = p.vy[i];
      q.vz[to] = p.vz[i];
    }
  }
  return all;
}

void account(State& state, double dt, const PassSums& sums) {
  const double h = dt / 2;
  state.ledger.W_box += h * (state.sums.box_power + sums.box_power);
  state.ledger.D_contact += h * (state.sums.contact_power + sums.contact_power);
  state.ledger.D_background += h * (state.sums.drag_power + sums.drag_power);
  state.sums = sums;
}

void open_ledger(State& state) {
  const double E_kin = kinetic_energy(state.packing);
  state.ledger = {};
  state.ledger.E_start = E_kin + state.sums.E_pot;
  state.ledger.E_kin_start = E_kin;
}

double kinetic_energy(const Packing& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    twice += p.mass[i] * (p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
  }
  return twice / 2;
}

double energy_residual(const State& state) {
  const Ledger& ledger = state.ledger;
  const double lost = ledger.D_contact + ledger.D_background;
  const double scale = std::abs(ledger.W_box) + ledger.E_kin_start + lost;
  if (scale == 0) return 0;
  const double change = kinetic_energy(state.packing) + state.sums.E_pot - ledger.E_start;
  return (ledger.W_box - change - lost) / scale;
}

}  // namespace grainlaw::dem
