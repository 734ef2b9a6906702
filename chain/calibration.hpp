#pragma once
// From a spec, or from a data set that is there, to the calibrated law and the folder of a calibration:
//   spec.resolved.json, runs/, dataset/, calibration.json, fitted_paths.json, parameters.json       (docs/formats.md)

#include <filesystem>
#include <functional>
#include <optional>

#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/spec_file.hpp"
#include "fit/calibrate.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::chain {

/// What is calibrated: a data set, or the spec of one that is to be simulated.
struct CalibrationInput {
  std::optional<dem::Spec> spec;              ///< of the data set; none when a given one does not say
  std::optional<Dataset> dataset = {};        ///< fitted without running DEM; none: `spec` is simulated
  std::filesystem::path dataset_folder = {};  ///< where `dataset` was read
};

/// Reads SPEC.json, the data set of a folder, or both; one of the two may be empty. Throws InvalidInput naming file and
/// key, also for tests that no fit can be made of.
CalibrationInput read_calibration_input(const std::filesystem::path& spec, const std::filesystem::path& dataset);

/// The same with a spec that has been read, `name` in messages; one of the two may be missing.
CalibrationInput calibration_input(std::optional<dem::Spec> spec, const std::string& name,
                                   const std::filesystem::path& dataset);

/// The fit's options as the input's spec asks for them.
fit::CalibrationOptions fit_options_of(const CalibrationInput& input, const Execution& execution);

struct CalibrationResult {
  Dataset dataset;               ///< as it is in `dataset/`
  fit::Calibration calibration;  ///< its `law` is what parameters.json holds
  dem::RunCounts counts;         ///< zero for a given data set
  double fit_seconds = 0;        ///< wall time of the fit [s]
};

/// Simulates what is not finished yet, fits, and writes the folder `output`. `options.coupling` overrides the spec's.
/// Throws InvalidInput, Error, Interrupted (then what was finished is kept and found again). A stage of the fit that
/// does not converge is said in `calibration`, not thrown. Several processes may calibrate into one folder: they share the
/// runs and write their results one after another.
CalibrationResult calibrate(CalibrationInput input, const fit::CalibrationOptions& options,
                            const std::filesystem::path& output, const Execution& execution,
                            dem::MissingRuns missing = dem::MissingRuns::simulated);

/// The first part of it: simulates the tests of `spec` into `folder`, with the runs in `output`/runs. `before_writing` is called
/// when all runs are there and nothing else has changed yet.
Dataset simulate_data_set(const dem::Spec& spec, const std::filesystem::path& folder,
                          const std::filesystem::path& output, const Execution& execution, dem::RunCounts& counts,
                          const std::function<void()>& before_writing = {},
                          dem::MissingRuns missing = dem::MissingRuns::simulated);

}  // namespace grainlaw::chain
