#pragma once
// Manual pages, from the table of commands and options.

#include <CLI/CLI.hpp>
#include <filesystem>

namespace grainlaw::app {

/// Writes grainlaw.1 and, for each command, grainlaw-COMMAND.1 into `folder`; returns how many.
int write_manual(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace grainlaw::app
