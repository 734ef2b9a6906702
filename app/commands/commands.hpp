#pragma once
// The commands: each declares its options on a subcommand of the command line, and returns the recipe that runs with them.

#include <CLI/CLI.hpp>
#include <functional>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"

namespace grainlaw::app {

/// What the user asked for.
using Task = std::function<ExitCode(Session&)>;

struct Command {
  const char* name;
  const char* description;
  Task (*declare)(CLI::App&);
  /// `says`: no options of work; `watches`: works on one thread; `simulates`: DEM
  enum class Kind { says, watches, computes, simulates } kind;
};

Task declare_simulate(CLI::App& command);
Task declare_import(CLI::App& command);
Task declare_calibrate(CLI::App& command);
Task declare_runs(CLI::App& command);
Task declare_task(CLI::App& command);
Task declare_submit(CLI::App& command);
Task declare_export(CLI::App& command);
Task declare_predict(CLI::App& command);
Task declare_report(CLI::App& command);
Task declare_study_integrator(CLI::App& command);
Task declare_study_dem(CLI::App& command);
Task declare_study_fit(CLI::App& command);
Task declare_study_chain(CLI::App& command);
Task declare_study_bands(CLI::App& command);
Task declare_study_prior(CLI::App& command);
Task declare_init(CLI::App& command);
Task declare_check(CLI::App& command);
Task declare_completion(CLI::App& command);
Task declare_man(CLI::App& command);

}  // namespace grainlaw::app
