#pragma once
// grainlaw predict PARAMETERS.json PATH.json -o DIR: the calibrated law along a strain path, and how far it is from runs
// of the same path: with --dem in the engine on new packings, with --against finished ones.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "app/exit_code.hpp"
#include "predict/prediction_files.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct PredictOptions {
  std::filesystem::path parameters;  ///< parameters.json of a calibration
  std::filesystem::path path;        ///< PATH.json
  std::filesystem::path output;      ///< folder of the prediction
  std::optional<Rung> model;         ///< none: reduced, evolution, and memory where it is calibrated
  std::optional<predict::Initial> initial;    ///< none: law, and measured too with `dem` or `against`
  bool dem = false;                  ///< run the path in the engine too
  std::filesystem::path against;     ///< data set with runs of the path; empty: none
  std::vector<std::uint64_t>
      seeds;                    ///< of the new packings; empty: PATH's, else as many as calibrated, following those
  std::filesystem::path spec;   ///< SPEC of the packings; empty: spec.resolved.json beside `parameters`
  std::filesystem::path store;  ///< folder with the runs; empty: that of `parameters`
};

ExitCode run_prediction(const PredictOptions& options, Session& session);

}  // namespace grainlaw::app
