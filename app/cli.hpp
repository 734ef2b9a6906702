#pragma once
// The command line: a table of commands, their options, and what becomes of errors.

namespace grainlaw::app {

/// Runs the command that the arguments name; the exit code (app/exit_code.hpp). Never throws.
int run(int argc, char** argv);

}  // namespace grainlaw::app
