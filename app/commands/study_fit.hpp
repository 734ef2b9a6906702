#pragma once
// grainlaw study fit FOLDER -o DIR: what a fit loses that leaves out a part of the data, or weighs them otherwise, against the
// fit of everything. No DEM runs.

#include <filesystem>
#include <string>
#include <vector>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

struct StudyFitOptions {
  std::filesystem::path dataset;  ///< folder of a data set or of a calibration
  std::filesystem::path path;     ///< PATH.json of the prediction that is judged by; empty: the laws are
  std::filesystem::path output;   ///< folder for study.json and settings.svg
  std::vector<std::string> vary;  ///< KEY=VALUE, one setting each; none: the usual ones (fit_choices.hpp)
};

ExitCode study_fit(const StudyFitOptions& options, Session& session);

}  // namespace grainlaw::app
