#pragma once
// grainlaw study integrator -o DIR: what the integration of a path costs at which error, by CVODE, by explicit methods and
// by substeps; and many paths over the cores.

#include <filesystem>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct StudyIntegratorOptions {
  std::filesystem::path output;      ///< folder for study.json and work_precision.svg
  std::filesystem::path parameters;  ///< parameters.json; empty: the published values
  int repeats = 50;                  ///< of each path; the least time counts
  int paths = 100000;                ///< of the batch
};

ExitCode study_integrator(const StudyIntegratorOptions& options, Session& session);

}  // namespace grainlaw::app
