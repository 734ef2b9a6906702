// grainlaw simulate TEST.json -o DIR: one packing, or one element test.

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/forecast_text.hpp"
#include "app/terminal/result_text.hpp"
#include "dem/runs/simulation.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

struct SimulateOptions {
  std::filesystem::path test;    ///< TEST.json
  std::filesystem::path output;  ///< folder for series, states, summary and the store of runs
  std::optional<int> frames;     ///< states on the way of each segment; none: as TEST says
  bool dry_run = false;
};

ExitCode simulate(const SimulateOptions& options, Session& session) {
  dem::TestFile test = dem::read_test(options.test);
  const bool lammps = test.preparation.choice.is_lammps();
  if (options.frames && (lammps || test.start == dem::Start::preparation))
    throw InvalidInput(fmt::format("{}: --frames: {}", options.test.string(),
                                   lammps ? "belongs to the engine 'grainlaw'; remove it from what LAMMPS runs"
                                          : "a preparation has no frames; use 'keep'"));
  test.frames = options.frames.value_or(test.frames);
  if (options.dry_run)
    return say_forecast(options.test.string(), chain::forecast(test, options.output, session), session);
  const dem::SimulationResult simulation = dem::simulate(test, options.output, session);
  print_result(session.json ? json_text(simulation.summary) : text_of(simulation, options.output));
  return ExitCode::ok;
}

}  // namespace

Task declare_simulate(CLI::App& command) {
  const auto options = std::make_shared<SimulateOptions>();
  add_value(command, "TEST", options->test, "FILE", "TEST.json")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder for series, states and summary")->required();
  add_number(command, "--frames", options->frames, 0, 9000, "N",
             "states kept on the way of each segment, at equal steps of the path");
  add_dry_run(command, options->dry_run);
  return [options](Session& session) { return simulate(*options, session); };
}

}  // namespace grainlaw::app
