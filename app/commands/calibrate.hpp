#pragma once
// grainlaw calibrate SPEC.json -o DIR: packings -> element tests -> data set -> fit -> parameters; with --target-error
// by the cheapest plan for a prediction (calibrate_target.hpp).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"
#include "fit/data/options.hpp"
#include "model/parameters.hpp"

namespace grainlaw::app {

struct CalibrateOptions {
  std::filesystem::path spec;           ///< SPEC.json; may be empty with `dataset`
  std::filesystem::path output;         ///< folder of the calibration
  std::filesystem::path dataset;        ///< fit this data set instead of running DEM; may be empty
  std::optional<Coupling> coupling;     ///< instead of the spec's
  std::optional<double> target_error;   ///< wanted error of the prediction along `target_path` [-]
  std::filesystem::path target_path;    ///< PATH.json of that prediction
  std::vector<std::string> quantities;  ///< those that are wanted; none: all that the path has
  double max_cost = 0;                  ///< of everything together; 0: no limit [s]
  fit::Loss loss = fit::Loss::squares;
  int starts = 1;       ///< of the coupled fits
  bool checks = false;  ///< fits without one packing, likelihood profiles
};

ExitCode calibrate(const CalibrateOptions& options, Session& session);

}  // namespace grainlaw::app
