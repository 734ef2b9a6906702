#pragma once
// What `import` says on standard output.

#include <filesystem>
#include <string>
#include <vector>

#include "chain/import/import.hpp"

namespace grainlaw::app {

/// A table for each set of tests whose columns are taken for the same: column, meaning, unit, sign.
std::string columns_text(const std::vector<chain::ForeignTest>& tests);

/// A line for each test: its path, how far rows were from it.
std::string paths_text(const std::vector<chain::ImportedTest>& tests);

std::string written_text(const Dataset& dataset, const std::filesystem::path& output);

/// All of it; `output` empty: nothing was written.
OrderedJson import_json(const std::vector<chain::ForeignTest>& foreign, const std::vector<chain::ImportedTest>& tests,
                        const std::string& output);

}  // namespace grainlaw::app
