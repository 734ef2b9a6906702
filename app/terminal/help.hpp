#pragma once
// What the program says of itself, from the table of its commands and options: help in 80 columns, the overview, slips of the
// hand. Manual pages and completions are made from the same: manual.hpp, completion.hpp.

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace grainlaw::app {

/// `text` in lines of at most `width` characters, broken at spaces.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// What help, manual and completion know of an option or a positional argument.
struct OptionText {
  std::vector<std::string> names;    ///< "-o", "--output"; of a positional argument its name
  std::string value;                 ///< FILE, DIR, "one|other", ...; empty for flags
  std::vector<std::string> choices;  ///< of the value; none: free, or files and folders
  std::string description;           ///< with range and default
  bool positional = false, required = false, many = false;
};

/// Of a command, positional arguments first; hidden ones are left out.
std::vector<OptionText> options_of(const CLI::App& command);

/// Commands below `app` that are not hidden.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// "grainlaw study dem".
std::string full_name(const CLI::App& command);

/// "calibrate [SPEC] -o DIR [OPTIONS]", the command's words with full_name() before them.
std::string synopsis(const CLI::App& command);

/// Lays help out for `app` and all commands that it gets afterwards.
void use_own_help(CLI::App& app);

/// What `grainlaw` alone says.
std::string overview(const CLI::App& app);

/// The command that `words` name, as far as they do, e.g. of {"study", "dem", "x.json"}.
const CLI::App& command_of(const CLI::App& app, const std::vector<std::string>& words);

/// "unknown command 'calibrat'; did you mean calibrate?" for the first command or option among `words` that there is not; empty
/// when there is none.
std::string slip_in(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace grainlaw::app
