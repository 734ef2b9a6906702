#include "dem/statics/balance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "dem/statics/stiffness.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kReach = 0.2;  // of pairs beyond contact, over <r>; a step that moves a sphere half as far is refused
constexpr double kForcing = 1e-4;  // residual of a Newton step's linear equations over its forces
constexpr int kMaxIterations = 20000;
constexpr int kMaxSteps = 30, kMaxHalvings = 6;
constexpr double kFirstMinimum = 1e-5,
                 kNextMinimum = 1e-2;  // tolerance of the minimiser, and its factor when called again
constexpr int kMinimisations = 4;

struct Configuration {
  std::vector<NetworkContact> contacts;
  NetworkForces forces;

  Configuration(const State& state, const std::vector<NetworkPair>& pairs)
      : contacts(contacts_at(state.packing, pairs)),
        forces(forces_of(contacts, state.packing.size(), state.material.stiffness)) {}
  double residual() const { return contacts.empty() ? 0 : forces.max_net_force / forces.mean_contact_force; }
};

void displace(Packing& packing, const Eigen::Matrix3d& inverse, const Eigen::Matrix3Xd& u, double factor) {
  for (std::size_t i = 0; i < packing.size(); ++i) {
    const Eigen::Vector3d ds = factor * (inverse * u.col(static_cast<Eigen::Index>(i)));
    packing.sx[i] += ds[0];
    packing.sy[i] += ds[1];
    packing.sz[i] += ds[2];
  }
}

/// Newton's method from where the state is; the state stays at the least residual that was met.
void newton(State& state, const BalanceOptions& options, const RunControl& control, Balance& result) {
  const double reach = kReach * mean_radius(state.packing), k = state.material.stiffness;
  const std::vector<NetworkPair> pairs = pairs_within(state.packing, reach, options.threads);
  const Eigen::Matrix3d inverse = state.packing.H.inverse();
  Configuration now(state, pairs);
  double moved = 0;  // at most, by any sphere since the pairs were listed [m]
  for (int step = 0; step < kMaxSteps && now.residual() > options.aim; ++step) {
    const StiffnessSolution solution =
        solve_stiffness(now.contacts, k, now.forces.net, kForcing, kMaxIterations, control.stop);
    result.iterations += solution.iterations;
    moved += std::sqrt(solution.u.colwise().squaredNorm().maxCoeff());
    if (solution.end != SolveEnd::solved || !(moved < reach / 2)) break;
    bool better = false;
    double factor = 1;
    for (int halving = 0; halving <= kMaxHalvings && !better; ++halving, factor /= 2) {
      State there = state;
      displace(there.packing, inverse, solution.u, factor);
      Configuration next(there, pairs);
      better = next.residual() < now.residual();
      if (!better) continue;
      state = std::move(there);
      now = std::move(next);
    }
    if (!better) break;
    ++result.newton_steps;
  }
  result.residual = now.residual();
}

}  // namespace

Balance balance(State& state, const BalanceOptions& options, const RunControl& control) {
  Balance result;
  if (state.packing.size() == 0) {
    result.reached = true;
    return result;
  }
  newton(state, options, control, result);
  double minimum = kFirstMinimum;
  for (int call = 0; call < kMinimisations && !(result.residual <= options.tolerance);
       ++call, minimum *= kNextMinimum) {
    EngineOptions engine;
    engine.threads = options.threads;
    result.passes += relax(state, engine, {minimum, options.max_passes}, control).passes;
    newton(state, options, control, result);
  }
  result.reached = result.residual <= options.tolerance;
  return result;
}

}  // namespace grainlaw::dem
