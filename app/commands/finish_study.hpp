#pragma once
// How every study ends: study.json and its figure in the folder, the result on standard output.

#include <filesystem>

#include "app/exit_code.hpp"
#include "app/report/figure_study.hpp"
#include "app/report/svg_figure.hpp"
#include "app/terminal/session.hpp"
#include "app/terminal/study_text.hpp"
#include "chain/studies/settings_study.hpp"

namespace grainlaw::app {

/// `figure` is the name of the picture's file, nullptr of a study without one. Throws Error when a file cannot be written.
template <class Study>
ExitCode finish_study(const Study& study, const std::filesystem::path& output, const char* figure,
                      const Session& session) {
  OrderedJson document = study_to_json(study);
  document["provenance"] = provenance(session);
  write_json(output / "study.json", document);
  if constexpr (requires { report::figure_of(study); }) report::write_svg(output / figure, report::figure_of(study));
  print_result(session.json ? json_text(document) : study_text(study) + (output / "study.json").string() + "\n");
  return ExitCode::ok;
}

}  // namespace grainlaw::app
