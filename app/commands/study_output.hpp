#pragma once
// How every study ends: study.json and its figure in the folder, the result on standard output.

#include <filesystem>
#include <string>

#include "model/files/json_document.hpp"
#include "app/report/figure.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

/// Adds the provenance to `document`; prints it with --json, else `text` and the file's name.
void finish_study(const std::filesystem::path& folder, OrderedJson document, const std::string& figure_file,
                  const report::Figure& figure, const std::string& text, const Session& session);

}  // namespace grainlaw::app
