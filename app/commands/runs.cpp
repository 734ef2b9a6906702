// grainlaw runs SPEC.json -o DIR: the runs that a calibration needs and which are missing; --array deals them out to tasks.

#include <fmt/format.h>

#include <algorithm>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/run_list_text.hpp"
#include "chain/calibration.hpp"
#include "chain/rehearsals.hpp"
#include "dem/runs/task_list.hpp"

namespace grainlaw::app {
namespace {

struct RunsOptions {
  std::filesystem::path spec;    ///< SPEC.json
  std::filesystem::path output;  ///< folder of the calibration
  int tasks = 0;                 ///< to deal the missing runs out to; 0: list them alone
};

ExitCode runs(const RunsOptions& options, Session& session) {
  const chain::CalibrationInput input = chain::read_calibration_input(options.spec, {});
  const std::vector<dem::PlannedTest> tests = plan(*input.spec);
  if (options.tasks > 0) chain::require_rehearsals_of(dem::packing_of(*input.spec), options.output / "dataset");
  RunListing listing = listing_of(dem::listed(dem::runs_of(tests)), options.output);
  if (options.tasks > 0) listing.missing = dem::write_tasks(*input.spec, options.tasks, options.output, session).runs;
  print_result(session.json ? json_text(to_json(listing)) : text_of(listing, options.output));
  return ExitCode::ok;
}

}  // namespace

Task declare_runs(CLI::App& command) {
  const auto options = std::make_shared<RunsOptions>();
  add_value(command, "SPEC", options->spec, "FILE", "SPEC.json of the calibration")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder of the calibration, whose finished runs are found")
      ->required();
  add_number(command, "--array", options->tasks, 1, 100000, "N",
             "deal the missing runs out to at most N tasks of like work and write them to DIR/tasks, for task "
             "and submit");
  return [options](Session& session) { return runs(*options, session); };
}

}  // namespace grainlaw::app
