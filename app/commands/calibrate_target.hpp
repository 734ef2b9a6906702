#pragma once
// grainlaw calibrate SPEC.json --target-error E --for PATH.json: a pilot, the cheapest plan, and its runs.

#include <filesystem>
#include <functional>
#include <optional>

#include "app/commands/calibrate.hpp"
#include "model/files/dataset.hpp"
#include "dem/runs/spec_file.hpp"
#include "chain/planning/target_run.hpp"
#include "fit/calibrate.hpp"

namespace grainlaw::app {

/// What the options ask for in the frame. Throws InvalidInput for options, a frame, a path or quantities that no plan can be
/// made for.
chain::PrecisionTarget target_of(const CalibrateOptions& options, const std::optional<dem::Spec>& frame);

/// Simulates the tests of a spec into a folder.
using Simulate = std::function<Dataset(const dem::Spec& spec, const std::filesystem::path& folder)>;
/// Simulates and fits a spec, and writes all files of a calibration.
using Calibrate = std::function<fit::Calibration(const dem::Spec& spec, Dataset& dataset, double& fit_seconds)>;

/// Reaches for the target in the frame of `spec`; then the tests of other roles are run on the packings of the last round.
/// Writes plan.json and prints it.
ExitCode calibrate_for(const chain::PrecisionTarget& target, const dem::Spec& spec, const CalibrateOptions& options,
                       const Calibrate& calibrate_with, const Simulate& simulate, Session& session);

}  // namespace grainlaw::app
