#pragma once
// A calibration that goes on until a prediction is known to a wanted error: a pilot, the cheapest plan, and its runs.

#include <filesystem>
#include <string>
#include <vector>

#include "chain/calibration.hpp"
#include "chain/planning/target_run.hpp"

namespace grainlaw::chain {

/// The target `error` for the prediction along PATH.json; no `quantities`: all that the path has. Throws InvalidInput for
/// a path or quantities that no plan can be made for.
PrecisionTarget read_target(double error, const std::filesystem::path& path, const std::vector<std::string>& quantities,
                            double max_seconds);

struct TargetCalibration {
  TargetRun run;                                 ///< pilot, candidates, rounds, outcome
  dem::Spec planned;                             ///< of the last round
  OrderedJson document = OrderedJson::object();  ///< what plan.json holds
};

/// Reaches for `target` in the frame of `spec` (material, size distribution, tests); then the tests of other roles are run
/// on the packings of the last round. Writes the folder of a calibration (calibration.hpp) and plan.json. Throws as
/// calibrate() does, and InvalidInput with the frame's `name` in front where no plan can be made in it.
TargetCalibration calibrate_for(const PrecisionTarget& target, const dem::Spec& spec, const std::string& name,
                                const fit::CalibrationOptions& options, const std::filesystem::path& output,
                                const Execution& execution);

}  // namespace grainlaw::chain
