#pragma once
// grainlaw calibrate SPEC.json -o DIR: packings -> element tests -> data set -> fit -> parameters.

#include <filesystem>
#include <optional>

#include "app/exit_code.hpp"
#include "app/session.hpp"
#include "model/parameters.hpp"

namespace grainlaw::app {

struct CalibrateOptions {
  std::filesystem::path spec;        ///< SPEC.json; may be empty with `dataset`
  std::filesystem::path output;      ///< folder of the calibration
  std::filesystem::path dataset;     ///< fit this data set instead of running DEM; may be empty
  std::optional<Coupling> coupling;  ///< instead of the spec's
};

ExitCode calibrate(const CalibrateOptions& options, Session& session);

}  // namespace grainlaw::app
