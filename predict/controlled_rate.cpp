#include "predict/controlled_rate.hpp"

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kDecay = 200;  // kappa, per strain: drift is gone after a percent of it
constexpr int kMostIterations = 60;
constexpr double kSmall = 1e-13;      // of a residual over the moduli
constexpr double kDifference = 1e-7;  // of the free rates, for the tangent

/// Rate of the condition's quantity.
double rate_of(const Condition& condition, const LawState<double>& state, const LawState<double>& rate) {
  switch (condition.quantity) {
    case Condition::Quantity::P_star:
      return rate.P;
    case Condition::Quantity::stress: {
      const auto [i, j] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
      return tensor_of(rate.sigma)(i, j) + (i == j ? rate.P : 0);
    }
    case Condition::Quantity::stress_ratio:
      break;
  }
  const double norm = state.sigma.norm();
  const double along = norm > 0 ? state.sigma.dot(rate.sigma) / norm : rate.sigma.norm();
  return (along - norm / state.P * rate.P) / state.P;
}

}  // namespace

double ControlledRate::value(const Condition& condition, const LawState<double>& state) {
  if (condition.quantity == Condition::Quantity::P_star) return state.P;
  if (condition.quantity == Condition::Quantity::stress_ratio) return state.sigma.norm() / state.P;
  const auto [i, j] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
  return tensor_of(state.sigma)(i, j) + (i == j ? state.P : 0);
}

ControlledRate::ControlledRate(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                               const PathSegment& segment, double nu_0, const ControlledState& start)
    : parameters_(parameters), rung_(rung), coupling_(coupling), segment_(segment), nu_0_(nu_0) {
  const auto count = static_cast<Eigen::Index>(segment.conditions.size());
  values_at_start_.resize(count);
  a_ = Free::Zero(count);
  for (Eigen::Index k = 0; k < count; ++k)
    values_at_start_(k) = value(segment.conditions[static_cast<std::size_t>(k)], start.law);
}

Eigen::Matrix3d ControlledRate::strain_rate(const Free& a) const {
  Eigen::Matrix3d D = segment_.direction.tensor;
  for (Eigen::Index k = 0; k < a.size(); ++k)
    D += a(k) * free_direction(segment_.conditions[static_cast<std::size_t>(k)]).tensor;
  return D;
}

LawState<double> ControlledRate::law_rate_of(const LawState<double>& state, const Eigen::Matrix3d& D) const {
  return law_rate(moduli_, parameters_, rung_, coupling_, state, law_direction(Eigen::Matrix3d(D + segment_.spin)));
}

ControlledRate::Free ControlledRate::residual(const LawState<double>& state, const Free& a, const Free& wanted) const {
  const LawState<double> rate = law_rate_of(state, strain_rate(a));
  Free r(a.size());
  for (Eigen::Index k = 0; k < a.size(); ++k)
    r(k) = rate_of(segment_.conditions[static_cast<std::size_t>(k)], state, rate) - wanted(k);
  return r;
}

ControlledState ControlledRate::operator()(double e, const ControlledState& y) {
  moduli_ = law_moduli(parameters_, y.nu(nu_0_), rung_);
  const Eigen::Index count = a_.size();
  Free wanted(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Condition& condition = segment_.conditions[static_cast<std::size_t>(k)];
    const double target = values_at_start_(k) + condition.rate * e;
    wanted(k) = condition.rate - kDecay * (value(condition, y.law) - target);
  }
  Free r = residual(y.law, a_, wanted);
  for (int iteration = 0; count > 0 && !(r.norm() <= kSmall * moduli_.B); ++iteration) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> tangent(count, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      Free beside = a_;
      beside(k) += kDifference;
      tangent.col(k) = (residual(y.law, beside, wanted) - r) / kDifference;
    }
    const Free step = tangent.fullPivLu().solve(r);
    // halved until it helps: far from the solution the norm of the strain rate bends the residual
    double part = 1;
    Free next = a_ - step, r_next = residual(y.law, next, wanted);
    while (!(r_next.norm() < r.norm()) && part > 1e-6) {
      part /= 2;
      next = a_ - part * step;
      r_next = residual(y.law, next, wanted);
    }
    const bool stuck = !(r_next.norm() < r.norm());
    if (stuck && r.norm() <= 1e-9 * moduli_.B) break;  // as small as rounding lets it be
    if (stuck || iteration == kMostIterations)
      throw NotConverged(
          "no free strain rate keeps to the conditions; they ask for a stress that the state cannot carry");
    a_ = next;
    r = r_next;
  }
  const Eigen::Matrix3d D = strain_rate(a_);
  return {law_rate_of(y.law, D), D, deviatoric_norm(D)};
}

}  // namespace grainlaw::predict
