#pragma once
// grainlaw simulate TEST.json -o DIR: one packing, or one element test.

#include <filesystem>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct SimulateOptions {
  std::filesystem::path test;    ///< TEST.json
  std::filesystem::path output;  ///< folder for series, state, summary and the store of runs
};

ExitCode simulate(const SimulateOptions& options, Session& session);

}  // namespace grainlaw::app
