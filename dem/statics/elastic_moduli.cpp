#include "dem/statics/elastic_moduli.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "dem/engine/averages.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kReversible = 1e-3;  // hysteresis beyond which a step has rearranged spheres

/// The load-carrying spheres at rest and what belongs to them.
struct Rest {
  State state;
  std::vector<NetworkContact> contacts;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // from the axes of the cell to those of the strain
  Balance balance;

  Vector6 stress() const {
    const double k = state.material.stiffness;
    return stress_coordinates(turn * stress_of(contacts, k, state.packing.volume()) * turn.transpose());
  }
};

Rest settle(State state, const Eigen::Matrix3d& turn, int threads, const RunControl& control) {
  Rest rest;
  rest.turn = turn;
  rest.state = std::move(state);
  rest.balance = balance(rest.state, BalanceOptions{.threads = threads}, control);
  rest.contacts = contacts_at(rest.state.packing, pairs_within(rest.state.packing, 0, threads));
  return rest;
}

/// The spheres of `state` that carry load, at rest. Newton's steps may show further rattlers.
Rest settled_backbone(const State& state, int threads, const RunControl& control) {
  Rest rest = settle(backbone_of(state, threads), Eigen::Matrix3d::Identity(), threads, control);
  for (;;) {
    State fewer = backbone_of(rest.state, threads);
    if (fewer.packing.size() == rest.state.packing.size()) return rest;
    rest = settle(std::move(fewer), Eigen::Matrix3d::Identity(), threads, control);
  }
}

Eigen::Matrix3d exponential(const Eigen::Matrix3d& strain) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(strain);
  return eigen.eigenvectors() * eigen.eigenvalues().array().exp().matrix().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// An upper-triangular cell Q^T H with positive diagonal, and Q.
std::pair<Eigen::Matrix3d, Eigen::Matrix3d> upright(const Eigen::Matrix3d& H) {
  if (H.isUpperTriangular(0)) return {H, Eigen::Matrix3d::Identity()};
  const Eigen::HouseholderQR<Eigen::Matrix3d> qr(H);
  Eigen::Matrix3d R = qr.matrixQR().triangularView<Eigen::Upper>(), Q = qr.householderQ();
  for (int a = 0; a < 3; ++a) {
    if (R(a, a) > 0) continue;
    R.row(a) *= -1;
    Q.col(a) *= -1;
  }
  return {R, Q};
}

/// `from` strained by `strain` (tension positive) and the displacements `u` on top, at rest again.
Rest step_to(const Rest& from, const Eigen::Matrix3d& strain, const Eigen::Matrix3Xd& u, int threads,
             const RunControl& control) {
  State state = from.state;
  Packing& p = state.packing;
  const Eigen::Matrix3d H = exponential(strain) * from.turn * p.H, inverse = H.inverse();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d ds = inverse * u.col(static_cast<Eigen::Index>(i));
    p.sx[i] += ds[0], p.sy[i] += ds[1], p.sz[i] += ds[2];
  }
  const auto [R, Q] = upright(H);
  p.H = R;
  return settle(std::move(state), Q, threads, control);
}

/// Steps to +h and -h along one direction, and back.
struct StepPair {
  Vector6 slope = Vector6::Zero();  // central difference of (P, sigma') [Pa]
  double asymmetry = 0;
  bool at_rest = true;
};

StepPair step_both_ways(const Rest& rest, const Vector6& direction, const LinearResponse& response, double h,
                        int threads, const RunControl& control, ElasticSteps& seen) {
  Eigen::Matrix3Xd u = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(rest.state.packing.size()));
  if (response.end == SolveEnd::solved) {
    for (int a = 0; a < 6; ++a) u += direction[a] * response.u[static_cast<std::size_t>(a)];
  }
  const Vector6 y_0 = rest.stress();
  Vector6 y[2];
  StepPair pair;
  for (const int side : {0, 1}) {
    const double strain = side == 0 ? -h : h;
    const Eigen::Matrix3d eps = strain_of(strain * direction);
    const Rest there = step_to(rest, eps, strain * u, threads, control);
    const Rest back = step_to(there, -eps, -strain * u, threads, control);
    y[side] = there.stress();
    const auto [closed, opened] = differing_contacts(rest.contacts, there.contacts);
    seen.contacts_closed += closed;
    seen.contacts_opened += opened;
    const double hysteresis = (back.stress() - y_0).norm() / (y[side] - y_0).norm();
    seen.hysteresis = std::max(seen.hysteresis, hysteresis);
    if (!(hysteresis <= kReversible)) ++seen.rearranged;
    seen.residual = std::max({seen.residual, there.balance.residual, back.balance.residual});
    pair.at_rest = pair.at_rest && there.balance.reached && back.balance.reached;
  }
  pair.slope = (y[1] - y[0]) / (2 * h);
  pair.asymmetry = (y[1] + y[0] - 2 * y_0).norm() / (y[1] - y[0]).norm();
  return pair;
}

/// The 2 x 2 part of a tangent that steps of volume and along N see, from its two columns.
Moduli moduli_of(const Vector6& by_x, const Vector6& by_e, const Deviator<double>& N) {
  return {by_x[0], by_e.tail<5>().dot(N), by_e[0], by_x.tail<5>().dot(N)};
}

ElasticSteps step_with(const Rest& rest, const Deviator<double>& N, const LinearResponse& response, double h,
                       int threads, const RunControl& control) {
  ElasticSteps seen;
  seen.h = h;
  Vector6 along;
  along << 0, N;
  const StepPair vol = step_both_ways(rest, Vector6::Unit(0), response, h, threads, control, seen);
  const StepPair dev = step_both_ways(rest, along, response, h, threads, control, seen);
  seen.asymmetry_vol = vol.asymmetry;
  seen.asymmetry_dev = dev.asymmetry;
  if (vol.at_rest && dev.at_rest) seen.central = moduli_of(vol.slope, dev.slope, N);
  return seen;
}

Observation observe_at_rest(State state, const Deviator<double>& N) {
  EngineOptions engine;
  engine.precision = Precision::reference;
  engine.refuse_deep_overlaps = false;
  const CellMotion motion{state.packing.H, Eigen::Matrix3d::Zero(), Transport::homogeneous};
  return observe(Simulation(std::move(state), engine, motion), motion, N);
}

void check_options(const Deviator<double>& N, const ProbeOptions& options) {
  if (!(std::abs(N.norm() - 1) < 1e-9)) throw InvalidInput("probe: its shear direction must have the norm 1");
  for (const double h : options.steps) {
    if (!(h > 0 && h <= 0.01)) throw InvalidInput(fmt::format("probe step: {} is not in (0, 0.01]", h));
  }
}

}  // namespace

ElasticProbe probe_moduli(State state, const Deviator<double>& N, const ProbeOptions& options,
                          const RunControl& control) {
  check_options(N, options);
  ElasticProbe probe;
  EngineOptions engine;
  engine.threads = options.threads;
  const Relaxation relaxation = relax(state, engine, options.relax, control);
  probe.passes = relaxation.passes;
  const Rest rest = settled_backbone(state, options.threads, control);
  probe.state = observe_at_rest(state, N);
  probe.relaxed = relaxation.relaxed && rest.balance.reached;
  probe.residual = rest.balance.residual;
  probe.spheres = rest.state.packing.size();
  probe.contacts = rest.contacts.size();
  if (rest.contacts.empty()) return probe;

  const LinearResponse response =
      linear_response(rest.state.packing, rest.contacts, state.material.stiffness, control.stop);
  probe.stable = response.end == SolveEnd::solved;
  probe.tangent = response.relaxed;
  const Vector6 by_e = response.relaxed.rightCols<5>() * N;
  probe.moduli = moduli_of(response.relaxed.col(0), by_e, N);
  probe.B_affine = response.affine(0, 0);
  for (const double h : options.steps) {
    probe.steps.push_back(step_with(rest, N, response, h, options.threads, control));
  }
  return probe;
}

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
