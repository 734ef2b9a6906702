#pragma once
// SUNDIALS CVODE for a small system dy/dt = f(t, y), y(t_0) = y_0, behind a header without SUNDIALS in it.
//   adams: variable order 1-6, functional iteration; bdf: variable order 1-5, Newton with a dense matrix
// After every call y must be finite and t exactly the requested one, otherwise the call has failed: the library is
// known to report success with a wrong y when its step vanishes, and to loop when a root function is not a number.

#include <memory>
#include <span>

#include "predict/solvers/ode.hpp"

namespace grainlaw::predict {

class Cvode {
 public:
  /// `size` unknowns. Throws Error when memory runs out or an option is refused.
  Cvode(std::size_t size, const Tolerances& tolerances, OdeRate rate, OdeEvent event = {}, OdeScale scale = {},
        OdeSensitivities sensitivities = {});
  ~Cvode();
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  /// (Re-)initialises at (t, y); the right-hand side is never evaluated beyond `t_stop` > t. Forgets all history.
  /// `sensitivities`: dy/dp_k at t, one after the other, or empty: none are carried along from here.
  void start(double t, std::span<const double> y, double t_stop, std::span<const double> sensitivities = {});

  /// Integrates to `t`, within [t of the previous call, t_stop] and after that of start(). `y` holds the state there,
  /// at the event, or NaN after a failure; start() again before going on from either of these. Exceptions of the rate
  /// pass through.
  Arrival advance(double t, std::span<double> y);

  /// Copies dy/dp_k, one after the other, at the place of the last advance().
  void sensitivities(std::span<double> out) const;

  /// Work of all starts together (without `seconds` and what the sensitivities take).
  SolverStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace grainlaw::predict
