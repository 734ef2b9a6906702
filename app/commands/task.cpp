// grainlaw task DIR K: the runs of one task of `grainlaw runs --array`, or single runs by name or key, on any machine.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "dem/runs/task_list.hpp"

namespace grainlaw::app {
namespace {

struct TaskOptions {
  std::filesystem::path folder;    ///< of the calibration
  std::vector<std::string> which;  ///< numbers of tasks, names or keys of runs
};

ExitCode make_task(const TaskOptions& options, Session& session) {
  const dem::TaskList list = dem::read_tasks(options.folder);
  const dem::RunCounts counts = dem::make_tasks(list, options.which, options.folder, session);
  if (session.json) {
    print_result(json_text({{"runs", counts.runs}, {"runs_found", counts.found}, {"runs_of_others", counts.others}}));
  } else {
    print_result(fmt::format("{}: {} runs, {} found finished, {} made by others meanwhile, {:.1f} s\n",
                             fmt::join(options.which, " "), counts.runs, counts.found, counts.others,
                             session.stopwatch.seconds()));
  }
  return ExitCode::ok;
}

}  // namespace

Task declare_task(CLI::App& command) {
  const auto options = std::make_shared<TaskOptions>();
  add_value(command, "DIR", options->folder, "DIR", "folder that grainlaw runs --array has written to")->required();
  add_value(command, "WHICH", options->which, "TASK",
            "number of a task, or name or key (eight digits will do) of a run; several are done in this order")
      ->required();
  return [options](Session& session) { return make_task(*options, session); };
}

}  // namespace grainlaw::app
