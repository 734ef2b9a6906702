#pragma once
// Dormand and Prince's explicit method of order 5 by Boost.Odeint: the method of ARKODE's order 5 (runge_kutta.hpp) for a number
// of unknowns that is known in advance, with everything inlined and on the stack, for rates of a tenth of a microsecond.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <limits>

#include "predict/solvers/ode.hpp"

namespace grainlaw::predict {

/// Root mean square of `off` over `weights`, the errors that are allowed.
template <std::size_t n>
double weighted_norm(const std::array<double, n>& off, const std::array<double, n>& weights) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += (off[i] / weights[i]) * (off[i] / weights[i]);
  return std::sqrt(sum / n);
}

/// Error of a step as Boost.Odeint asks for it; infinite where it is no number, so that the step is made shorter.
template <std::size_t n>
struct StepError {
  const std::array<double, n>* weights;

  template <class Algebra, class State, class Rate>
  double error(Algebra&, const State&, const Rate&, const std::array<double, n>& off, double) const {
    const double norm = weighted_norm(off, *weights);
    return std::isfinite(norm) ? norm : std::numeric_limits<double>::infinity();
  }
};

/// What a walk by it took.
struct DormandPrinceWork {
  long rhs_evaluations = 0;
  long steps = 0;  ///< attempts
};

/// Length of a first step by the first and second derivative there (Hairer, Norsett, Wanner, Solving Ordinary Differential
/// Equations I, II.4): a hundredth of the change that doubles y, and an error of the order of what is allowed.
template <std::size_t n, class Rate>
double first_step(const Rate& rate, const std::array<double, n>& y, const std::array<double, n>& slope,
                  const std::array<double, n>& weights, double length, double relative) {
  const double first = weighted_norm(slope, weights);
  if (!(first > 0)) return length;
  const double h = std::min(length, 0.01 / (relative * first));
  std::array<double, n> ahead, slope_ahead, change;
  for (std::size_t i = 0; i < n; ++i) ahead[i] = y[i] + h * slope[i];
  rate(ahead, slope_ahead, h);
  for (std::size_t i = 0; i < n; ++i) change[i] = slope_ahead[i] - slope[i];
  const double derivative = std::max(first, weighted_norm(change, weights) / h);
  return std::isfinite(derivative) ? std::min({length, 100 * h, std::pow(0.01 / derivative, 1. / 5)}) : h;
}

/// From (0, y) to `length` exactly, relative and absolute tolerance by `tolerances` as with CVODE. Adds to `work`.
/// `law`: its rate(e, y, out) and scale(e, y, out) are OdeRate and OdeScale.
template <class Law, std::size_t n>
Arrival integrate_dormand_prince(const Law& law, std::array<double, n>& y, double length, const Tolerances& tolerances,
                                 DormandPrinceWork& work) {
  using Vector = std::array<double, n>;
  using DormandPrince = boost::numeric::odeint::runge_kutta_dopri5<Vector>;
  Vector weights{};
  const auto rate = [&](const Vector& at, Vector& out, double e) {
    law.rate(e, at.data(), out.data());
    ++work.rhs_evaluations;
  };
  const auto set_weights = [&](double e) {
    law.scale(e, y.data(), weights.data());
    for (double& w : weights) w = tolerances.relative * w + tolerances.absolute;
  };
  set_weights(0);
  Vector slope{};
  rate(y, slope, 0);
  double step = first_step(rate, y, slope, weights, length, tolerances.relative);

  boost::numeric::odeint::controlled_runge_kutta<DormandPrince, StepError<n>> stepper(StepError<n>{&weights});
  double e = 0;
  for (const long last = work.steps + tolerances.max_steps; work.steps < last;) {
    const bool to_the_end = e + step * (1 + 1e-9) >= length;
    if (to_the_end) step = length - e;
    ++work.steps;
    const auto outcome = stepper.try_step(rate, y, slope, e, step);
    if (outcome == boost::numeric::odeint::success) {
      if (to_the_end) return {Arrival::Kind::reached, length, {}};
      set_weights(e);
    } else if (e + step <= e) {
      return {Arrival::Kind::failed, e, fmt::format("no step is small enough, the last was {:.3g}", step)};
    }
  }
  return {Arrival::Kind::failed, e, fmt::format("more than {} steps", tolerances.max_steps)};
}

}  // namespace grainlaw::predict
