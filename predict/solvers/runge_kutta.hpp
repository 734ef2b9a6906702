#pragma once
// ARKODE's explicit Runge-Kutta methods with error control for a small system dy/dt = f(t, y), y(t_0) = y_0, as cvode.hpp
// is for CVODE's. Order 2 Heun and Euler, 3 Bogacki and Shampine, 4 Zonneveld, 5 Dormand and Prince, 6 Verner,
// 8 Fehlberg.

#include <memory>
#include <span>

#include "predict/solvers/ode.hpp"

namespace grainlaw::predict {

class RungeKutta {
 public:
  /// `relative` and `absolute` as in Tolerances; `max_steps` between start() and advance(). Throws Error when memory
  /// runs out, InvalidInput for an order that there is not.
  RungeKutta(std::size_t size, int order, double relative, double absolute, long max_steps, OdeRate rate,
             OdeScale scale);
  ~RungeKutta();
  RungeKutta(const RungeKutta&) = delete;
  RungeKutta& operator=(const RungeKutta&) = delete;

  /// From (t, y) to `t_end` > t exactly, with a fresh history. Arrival::Kind::event does not occur. Exceptions of the
  /// rate pass through.
  Arrival integrate(double t, std::span<double> y, double t_end);

  long rhs_evaluations() const;  ///< of all calls
  long steps() const;            ///< of all calls, attempts that failed the error test included

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace grainlaw::predict
