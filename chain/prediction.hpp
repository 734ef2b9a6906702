#pragma once
// The calibrated law along a strain path, with bands, and how far it is from runs of the same path: new ones in the engine,
// on packings that the calibration has never seen, or finished ones.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dem/runs/spec_file.hpp"
#include "model/calibrated_law.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"
#include "model/files/path_file.hpp"
#include "predict/prediction_files.hpp"

namespace grainlaw::chain {

/// Runs of the path that are to be made.
struct NewRuns {
  dem::Spec spec;                    ///< how their packings are prepared
  std::vector<std::uint64_t> seeds;  ///< of the packings; empty: PATH's, else as many as calibrated, following those
  std::filesystem::path store;       ///< folder that holds runs/
  std::vector<std::uint64_t> fitted = {};  ///< seeds besides the spec's, of packings of its size that the law knows
};

/// Runs of the path that are there.
struct FinishedRuns {
  Dataset dataset;
  std::filesystem::path folder;
  std::vector<std::uint64_t> fitted = {};  ///< seeds of packings among them that were fitted, too
};

struct PredictionInput {
  CalibratedLaw law;
  Json parameters = {};  ///< where the law is from: {file, sha256, dataset_digest}; for the prediction's files
  std::filesystem::path law_file;  ///< parameters.json
  PathFile path;
  std::string path_name;                         ///< likewise
  std::optional<Rung> model = {};                ///< none: reduced, evolution, and memory where it is calibrated
  std::optional<predict::Initial> initial = {};  ///< none: the law's, and with runs the measured one too
  std::optional<NewRuns> new_runs = {};
  std::optional<FinishedRuns> finished_runs = {};
};

/// Reads parameters.json and PATH.json. Throws InvalidInput naming file and key.
PredictionInput read_prediction_input(const std::filesystem::path& parameters, const std::filesystem::path& path);

/// The same with a path that has been read, `path_name` in messages.
PredictionInput prediction_input(const std::filesystem::path& parameters, PathFile path, const std::string& path_name);

/// The spec by which new packings are prepared: `spec`, or when that is empty spec.resolved.json beside `parameters`. Throws
/// InvalidInput naming the file.
dem::Spec spec_of_calibration(const std::filesystem::path& spec, const std::filesystem::path& parameters);

/// Runs of the input's path on packings of `spec`, in `store` or, where that is empty, beside the law. Throws InvalidInput
/// where the data set beside the law is of another material.
NewRuns new_runs(const PredictionInput& input, dem::Spec spec, std::vector<std::uint64_t> seeds,
                 const std::filesystem::path& store);

/// The runs in the folder of a data set or of a prediction. Throws InvalidInput unless all follow the input's path, are of
/// the law's material and none was fitted, as far as their roles and the data set beside the law say.
FinishedRuns finished_runs(const PredictionInput& input, const std::filesystem::path& folder);

/// What the law does not know of a path, whatever rung follows it.
std::vector<std::string> warnings_along(const CalibratedLaw& law, const PathFile& path);

/// What predict_path() refuses before it writes anything: a path, a rung or a start that the law cannot serve, runs that cannot be made.
void check_prediction(const PredictionInput& input);

/// Curves of each rung, comparisons, the rung that the path needs. Writes the folder `output`: prediction.json, a CSV for
/// each curve, with runs dem/ and comparison.json. Throws InvalidInput before anything is written for a path, a rung or a
/// start that the law cannot serve. A curve on which the law does not converge is left out and told in `failures` and as a
/// warning; NotConverged where that leaves none (new runs and prediction.json stay). Interrupted, after which finished runs
/// are found again. No empty folder stays behind.
predict::PredictionFolder predict_path(const PredictionInput& input, const std::filesystem::path& output,
                                       const Execution& execution);

}  // namespace grainlaw::chain
