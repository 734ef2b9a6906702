#pragma once
// Choices of a calibration. Fit windows: equations.md 0.

#include <optional>

#include "fit/statistics/problem.hpp"
#include "fit/statistics/variance_prior.hpp"
#include "model/parameters.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::fit {

struct CalibrationOptions {
  Coupling coupling = Coupling::energy;
  double iso_nu_min = 0.675;  ///< ISO unloading rows below it leave the fit [-]
  double rate_window = 0.12;  ///< rates are fitted from the start of shear to this eps_dev [-]
  double steady_from = 0.15;  ///< steady means are taken from this eps_dev on, or from where a test is steady [-]
  double steady_weight = 3;   ///< of the steady rows together, times that of the rows up to rate_window together [-]
  double stiffness_window = 0.02;  ///< memory: stress ratios of shear are fitted to this eps_dev of a segment [-]
  double lag_window = 0.06;        ///< memory: fabrics likewise [-]
  double max_step = 2e-3;          ///< largest step of the fixed-step integrator in path strain [-]
  double pressure_scale = 0.01;    ///< relative misfit of P* that weighs one in the evolution stage [-]
  double stress_scale = 0.01;      ///< misfit of s that weighs one [-]
  double fabric_scale = 0.01;      ///< misfit of F that weighs one [-]
  Loss loss = Loss::squares;
  int starts = 1;                      ///< of the coupled stages, search.hpp
  bool profiles = false;               ///< of doubtful parameters, profile.hpp
  int threads = 1;                     ///< results do not depend on it
  std::optional<VariancePrior> prior;  ///< by which errors are moderated; none: those of the packings at hand alone
};
/// What calibration.json keeps of them as `options`; the coupling stands beside them.
GRAINLAW_SOME_FIELDS(CalibrationOptions, iso_nu_min, rate_window, steady_from, steady_weight, stiffness_window,
                     lag_window, max_step, pressure_scale, stress_scale, fabric_scale, loss, starts);

/// Throws InvalidInput naming the field that is not finite, not positive or out of order.
void check(const CalibrationOptions& options);

}  // namespace grainlaw::fit
