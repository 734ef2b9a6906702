#pragma once
// SUNDIALS CVODE for a small system dy/dt = f(t, y), y(t_0) = y_0, behind a header without SUNDIALS in it.
//   adams: variable order 1-6, functional iteration; bdf: variable order 1-5, Newton with a dense matrix
// After every call y must be finite and t exactly the requested one, otherwise the call has failed: the library is
// known to report success with a wrong y when its step vanishes, and to loop when a root function is not a number.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// Writes dy/dt at (t, y). A rate that is not finite makes the solver try a smaller step. May throw.
using OdeRate = std::function<void(double t, const double* y, double* rate)>;

/// The integration ends where this falls through zero. May be empty.
using OdeEvent = std::function<double(double t, const double* y)>;

/// Writes for each unknown the magnitude at (t, y) that the relative tolerance refers to. May be empty: |y| then.
using OdeScale = std::function<void(double t, const double* y, double* scale)>;

/// Writes the rate (df/dy) s + df/dp_k at (t, y) of the sensitivity s = dy/dp_k. May throw.
using OdeSensitivityRate = std::function<void(std::size_t k, double t, const double* y, const double* s, double* rate)>;

/// dy/dp_k, carried along beside y, each to five times the relative tolerance of y (and no less than 1e-10) of
/// itself, or of typical y over the magnitude of p_k where it is less than that.
struct OdeSensitivities {
  std::vector<double> magnitudes;  ///< of each p_k, positive
  OdeSensitivityRate rate;
  std::function<void(double* y)> typical;  ///< writes for each unknown what is typical of it, at start()
};

/// How one call of Cvode::advance ended.
struct Arrival {
  enum class Kind { reached, event, failed } kind = Kind::failed;
  double t = 0;         ///< where y is: the requested t, the place of the event, or where the solver gave up
  std::string message;  ///< the solver's own words on failure, else empty
};

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
