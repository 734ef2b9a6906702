#pragma once
// The report of a calibration's folder: one self-contained HTML page. It reads files, runs nothing and fits nothing.

#include <filesystem>
#include <string>

#include "model/files/json_document.hpp"

namespace grainlaw::app {

/// Writes the page about the folder `dir` to `html`, beside that of `compare` where one is given. Throws Error when a file
/// is missing (naming the command that makes it) and InvalidInput when one cannot be read.
void write_report(const std::filesystem::path& dir, const std::filesystem::path& html,
                  const std::filesystem::path& compare = {});

/// All that stands on that page, every number before rounding. Throws likewise.
OrderedJson report_json(const std::filesystem::path& dir, const std::filesystem::path& compare = {});

/// The parameters of `dir` as fixed-width text: parameter, symbol, ours +- standard error, 95 % interval, published; words where a
/// parameter is not identified. Throws like write_report.
std::string summary_table(const std::filesystem::path& dir);

}  // namespace grainlaw::app
