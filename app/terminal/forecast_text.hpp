#pragma once
// What a command would do, as text and JSON; the option that asks for it.

#include <CLI/CLI.hpp>
#include <string>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"
#include "chain/forecast.hpp"

namespace grainlaw::app {

CLI::Option* add_dry_run(CLI::App& command, bool& dry_run);

/// A few lines, indented.
std::string text_of(const chain::Forecast& forecast, int threads);

/// `name` and its forecast on standard output.
ExitCode say_forecast(const std::string& name, const chain::Forecast& forecast, const Session& session);

}  // namespace grainlaw::app
