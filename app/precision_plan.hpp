#pragma once
// How many packings a calibration needs until a prediction is known to a wanted error. Errors are those of the mean
// curve's 95 % band (predict/bands.hpp): between packings they fall as t_{n-1}/sqrt(n). More packings do not mend the law's
// own discrepancy, which is looked for in what the fit leaves over.

#include <functional>
#include <string>
#include <vector>

#include "app/files/spec_file.hpp"
#include "fit/calibrate.hpp"
#include "model/law.hpp"

namespace grainlaw::app {

struct PrecisionTarget {
  double error = 0.02;     ///< largest half width wanted, over the largest |value| on the path [-]
  Path path;               ///< that of the prediction
  double max_seconds = 0;  ///< of all rounds together; 0: no limit [s]
};

/// What is known of the prediction, by the richest rung that is calibrated.
struct PredictionError {
  Rung rung = Rung::reduced;
  std::string quantity;  ///< P_star, s_par or F_par, whichever is known worst
  double half_width =
      0;  ///< of its mean curve's 95 % band at the worst place, over the largest |value|; NaN: no band [-]
  double discrepancy = 0;  ///< of the law: largest over the quantities of the root mean square over the fitted paths of
                           ///< bias (mean over packings) over the largest |value| [-]
};
PredictionError prediction_error(const fit::Calibration& calibration, const Path& path);

/// Smallest number of packings whose half width would be `target`, judged from `half_width` with `packings` >= 2.
int packings_needed(double half_width, int packings, double target);

enum class PlanOutcome { met, discrepancy, max_cost, no_band };
std::string to_string(PlanOutcome outcome);

struct PlanRound {
  int packings = 0;
  double seconds = 0;  ///< since the begin of the first round [s]
  PredictionError error;
};

struct PrecisionPlan {
  PlanOutcome outcome = PlanOutcome::met;
  std::vector<PlanRound> rounds;
};

/// Calibrates with the spec's packings (three at least), then with as many as are needed, until the target is met or
/// cannot be. `calibrate_with` does the work of a round and keeps what it has simulated; `seconds` is the time since the
/// begin; `log` says what comes next.
PrecisionPlan reach(const PrecisionTarget& target, Spec spec,
                    const std::function<fit::Calibration(const Spec&)>& calibrate_with,
                    const std::function<double()>& seconds, const std::function<void(const std::string&)>& log);

}  // namespace grainlaw::app
