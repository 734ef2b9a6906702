#pragma once
// grainlaw predict PARAMETERS.json PATH.json -o DIR: the calibrated law along a strain path, and with --dem the same
// path in the engine on new packings, and how far apart they are.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "app/exit_code.hpp"
#include "app/files/prediction_files.hpp"
#include "app/session.hpp"

namespace grainlaw::app {

struct PredictOptions {
  std::filesystem::path parameters;  ///< parameters.json of a calibration
  std::filesystem::path path;        ///< PATH.json
  std::filesystem::path output;      ///< folder of the prediction
  std::optional<Rung> model;         ///< none: reduced, evolution, and memory where it is calibrated
  std::optional<Initial> initial;    ///< none: law, and measured too with `dem`
  bool dem = false;                  ///< run the path in the engine too
  std::vector<std::uint64_t>
      seeds;                    ///< of the new packings; empty: PATH's, else as many as calibrated, following those
  std::filesystem::path spec;   ///< SPEC of the packings; empty: spec.resolved.json beside `parameters`
  std::filesystem::path store;  ///< folder with the runs; empty: that of `parameters`
};

ExitCode run_prediction(const PredictOptions& options, Session& session);

}  // namespace grainlaw::app
