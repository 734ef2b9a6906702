// grainlaw simulate TEST.json -o DIR: one packing, or one element test.

#include "app/commands/commands.hpp"
#include "app/terminal/result_text.hpp"
#include "dem/runs/simulation.hpp"

namespace grainlaw::app {
namespace {

struct SimulateOptions {
  std::filesystem::path test;    ///< TEST.json
  std::filesystem::path output;  ///< folder for series, states, summary and the store of runs
};

ExitCode simulate(const SimulateOptions& options, Session& session) {
  const dem::SimulationResult simulation = dem::simulate(dem::read_test(options.test), options.output, session);
  print_result(session.json ? json_text(simulation.summary) : text_of(simulation, options.output));
  return ExitCode::ok;
}

}  // namespace

Task declare_simulate(CLI::App& command) {
  const auto options = std::make_shared<SimulateOptions>();
  command.add_option("TEST", options->test, "TEST.json")->required();
  command.add_option("-o,--output", options->output, "folder for series, states and summary")->required();
  return [options](Session& session) { return simulate(*options, session); };
}

}  // namespace grainlaw::app
