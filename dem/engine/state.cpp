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
  const std::size_t n = p.size();
  for (const auto same : {&Packing::radius, &Packing::mass, &Packing::vx, &Packing::vy, &Packing::vz}) {
    for (std::size_t i = 0; i < q.size(); ++i) (q.*same)[i] = (p.*same)[i % n];
  }
  const auto place = [&](double s, std::size_t tile) {
    return (s - std::floor(s) + static_cast<double>(tile)) / tiles;
  };
  for (std::size_t i = 0; i < q.size(); ++i) {
    const std::size_t tile = i / n;
    q.sx[i] = place(p.sx[i % n], tile % t);
    q.sy[i] = place(p.sy[i % n], tile / t % t);
    q.sz[i] = place(p.sz[i % n], tile / t / t);
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
