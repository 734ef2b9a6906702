#pragma once
// grainlaw study chain SPEC.json --for PATH.json -o DIR: what settings of the whole chain, from packings to a prediction, cost
// and how far the prediction is from that of a reference. The spec is the default that is judged.

#include <filesystem>
#include <string>
#include <vector>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct StudyChainOptions {
  std::filesystem::path spec;          ///< the base
  std::filesystem::path path;          ///< PATH.json of the prediction
  std::filesystem::path output;        ///< folder for study.json, settings.svg, data sets and runs
  std::vector<std::string> reference;  ///< KEY=VALUE, all together; none: the base is the reference
  std::vector<std::string> vary;       ///< KEY=VALUE, one setting each
};

ExitCode study_chain(const StudyChainOptions& options, Session& session);

}  // namespace grainlaw::app
