#pragma once
// What every solver of a small system dy/dt = f(t, y) is asked with and answers with.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "model/vocabulary/fields.hpp"

namespace grainlaw::predict {

enum class Method { adams, bdf };

struct Tolerances {
  double relative = 1e-8;         ///< of each unknown, in [1e-14, 1) [-]
  double absolute = 1e-12;        ///< on each unknown, not negative [-]
  Method method = Method::adams;  ///< how CVODE steps
  long max_steps = 100000;        ///< internal steps per output interval
};

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

struct SolverStatistics {
  long steps = 0, rhs_evaluations = 0, error_test_failures = 0, nonlinear_iterations = 0;  ///< of all starts
  long restarts = 0;   ///< initialisations: of a path, one for each segment entered and each event in it
  double seconds = 0;  ///< wall time of the integration [s]
};
constexpr auto fields_of(std::type_identity<SolverStatistics>) {
  using S = SolverStatistics;
  return std::tuple{Field{&S::steps, "steps"},
                    Field{&S::rhs_evaluations, "rhs_evaluations"},
                    Field{&S::error_test_failures, "error_test_failures"},
                    Field{&S::nonlinear_iterations, "nonlinear_iterations"},
                    Field{&S::restarts, "restarts"},
                    Field{&S::seconds, "seconds", "s"}};
}
static_assert(tells_every_member<SolverStatistics>());

}  // namespace grainlaw::predict
