#pragma once
// Completion of the command line in bash, zsh and fish, from the table of commands and options.

#include <CLI/CLI.hpp>
#include <string>

namespace grainlaw::app {

enum class Shell { bash, zsh, fish };
constexpr auto names_of(Shell) { return std::array{"bash", "zsh", "fish"}; }

/// One word of a POSIX shell.
std::string in_quotes(const std::string& text);

/// The script that the shell loads. `app` has all commands.
std::string completion_script(const CLI::App& app, Shell shell);

}  // namespace grainlaw::app
