#pragma once
// The commands: each declares its options on a subcommand of the command line, and returns the recipe that runs with them.

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"
#include "model/vocabulary/enum_names.hpp"

namespace grainlaw::app {

/// What the user asked for.
using Task = std::function<ExitCode(Session&)>;

struct Command {
  const char* name;
  const char* description;
  Task (*declare)(CLI::App&);
  bool simulates;  ///< DEM: takes --resume and --checkpoint
};

Task declare_simulate(CLI::App& command);
Task declare_calibrate(CLI::App& command);
Task declare_predict(CLI::App& command);
Task declare_report(CLI::App& command);
Task declare_study_integrator(CLI::App& command);
Task declare_study_dem(CLI::App& command);
Task declare_study_fit(CLI::App& command);
Task declare_study_chain(CLI::App& command);
Task declare_study_bands(CLI::App& command);
Task declare_study_prior(CLI::App& command);

/// The names of an enum as values of an option.
template <NamedEnum E>
CLI::CheckedTransformer by_name() {
  std::map<std::string, E> values;
  for (const E value : kValues<E>) values[to_string(value)] = value;
  return CLI::CheckedTransformer(values);
}

}  // namespace grainlaw::app
