#include "dem/statics/probe_rows.hpp"

namespace grainlaw::dem {

double stress_unit(const State& state) { return state.material.stiffness / (2 * mean_radius(state.packing)); }

std::vector<ProbeRow> rows_of(const ElasticProbe& probe, double unit) {
  ProbeRow row;
  static_cast<Observation&>(row) = probe.state;
  row.relaxed = probe.relaxed;
  row.residual = probe.residual;
  row.spheres = static_cast<int>(probe.spheres);
  row.contacts = static_cast<int>(probe.contacts);
  row.B_star = probe.moduli.B / unit;
  row.DG_star = probe.moduli.DG / unit;
  row.A1_star = probe.moduli.A1 / unit;
  row.A2_star = probe.moduli.A2 / unit;
  row.DG_mean_star = probe.tangent.bottomRightCorner<5, 5>().trace() / 5 / unit;
  row.B_affine_star = probe.B_affine / unit;
  row.A2_tensor_star.tensor = tensor_of<double>(probe.tangent.col(0).tail<5>()) / unit;
  std::vector<ProbeRow> rows;
  for (const ElasticSteps& seen : probe.steps) {
    row.step = seen.h;
    row.B_step_star = seen.central.B / unit;
    row.DG_step_star = seen.central.DG / unit;
    row.A1_step_star = seen.central.A1 / unit;
    row.A2_step_star = seen.central.A2 / unit;
    row.asymmetry_vol = seen.asymmetry_vol;
    row.asymmetry_dev = seen.asymmetry_dev;
    row.contacts_closed = static_cast<int>(seen.contacts_closed);
    row.contacts_opened = static_cast<int>(seen.contacts_opened);
    row.rearranged = seen.rearranged;
    row.hysteresis = seen.hysteresis;
    row.step_residual = seen.residual;
    rows.push_back(row);
  }
  if (rows.empty()) rows.push_back(row);
  return rows;
}

}  // namespace grainlaw::dem
