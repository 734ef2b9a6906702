#pragma once
// What a command would do, before it does anything: its runs, work, wall time on this machine, space on disk, and which
// densities and strains it covers. simulate, calibrate and predict --dry-run, and check, say the same by these calls, which
// write nothing. Time: the work over a rate that is measured now (dem/runs/expected_cost.hpp), the fit's in proportion.

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "chain/calibration.hpp"
#include "chain/planning/target_run.hpp"
#include "chain/prediction.hpp"
#include "dem/runs/expected_cost.hpp"
#include "model/rehearsals.hpp"

namespace grainlaw::chain {

struct Forecast {
  dem::ExpectedCost cost;
  /// measured now, all threads together [particle-steps/s]; NaN: nothing asks for it
  double rate = std::numeric_limits<double>::quiet_NaN();
  double run_seconds = 0;          ///< expected wall time of the runs that are not finished [s]
  double fit_seconds = 0;          ///< of the fit [s]
  PathTraits covers;               ///< of all paths together
  std::vector<std::string> notes;  ///< what else is to be known, e.g. in which ways a path leaves the calibrated range
};
constexpr auto fields_of(std::type_identity<Forecast>) {
  using F = Forecast;
  return std::tuple{Field{&F::cost, ""},
                    Field{&F::rate, "particle_steps_per_second"},
                    Field{&F::run_seconds, "run_seconds"},
                    Field{&F::fit_seconds, "fit_seconds"},
                    Field{&F::covers, "covers"},
                    Field{&F::notes, "notes"}};
}
static_assert(tells_every_member<Forecast>());

/// What calibrate() would do; finished runs in `output` are found.
Forecast forecast(const CalibrationInput& input, const std::filesystem::path& output, const Execution& execution);

/// Of a calibration with a target: its pilot, which is always run. What the plan takes follows from what that shows.
Forecast forecast_of_pilot(const PrecisionTarget& target, const dem::Spec& frame, const std::string& name,
                           const std::filesystem::path& output, const Execution& execution);

/// What simulate() would do.
Forecast forecast(const dem::TestFile& test, const std::filesystem::path& output, const Execution& execution);

/// What predict_path() would do. Throws InvalidInput, as that does, for runs that cannot be made.
Forecast forecast(const PredictionInput& input, const Execution& execution);

}  // namespace grainlaw::chain
