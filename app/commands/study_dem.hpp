#pragma once
// grainlaw study dem SPEC.json -o DIR: what settings of the engine cost and how far they are from a reference. The spec is
// the default that is judged; --reference and --vary change one key of it each.

#include <filesystem>
#include <string>
#include <vector>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct StudyDemOptions {
  std::filesystem::path spec;          ///< the base
  std::filesystem::path output;        ///< folder for study.json, settings.svg, data sets and runs
  std::vector<std::string> reference;  ///< KEY=VALUE, all together
  std::vector<std::string> vary;       ///< KEY=VALUE, one setting each
};

ExitCode study_dem(const StudyDemOptions& options, Session& session);

}  // namespace grainlaw::app
