#include "app/scheduler/job_watch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <optional>

#include "app/scheduler/slurm.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/expected_cost.hpp"
#include "dem/runs/task_list.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// Tells the watch which runs are finished or being made now; those in `told` were finished before.
void look(const std::vector<dem::PlannedRun>& runs, const fs::path& store, std::vector<bool>& told, Watch& watch) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (told[i]) continue;
    if (dem::is_finished(store, runs[i].key)) {
      told[i] = true;
      watch.finished(i);
    } else if (dem::maker_of(store, runs[i].key)) {
      watch.control(i, runs[i].name, {}).report({runs[i].name, 0, 0, "particle-steps"});
    }
  }
}

/// The exit code that the calibration's script has left; nothing when it was never started.
std::optional<int> exit_code_in(const fs::path& tasks) {
  std::ifstream file(tasks / "calibration.exit");
  int code = 0;
  return file >> code ? std::optional(code) : std::nullopt;
}

}  // namespace

ExitCode watch_jobs(const dem::Spec& spec, const fs::path& folder, const std::vector<std::string>& jobs,
                    const Session& session) {
  const std::vector<dem::PlannedTest> tests = plan(spec);
  const std::vector<dem::PlannedRun> runs = dem::runs_of(tests);
  const fs::path tasks = folder / dem::kTasksFolder;
  const std::string names = fmt::format("{}", fmt::join(jobs, ", "));
  session.watch.log(fmt::format("jobs {}; their logs are in {}", names, tasks.string()));
  std::vector<double> work;
  for (const dem::PlannedRun& run : runs) work.push_back(dem::expected_particle_steps(run));
  session.watch.begin(work, "particle-steps");
  std::vector<bool> told(runs.size());
  std::mutex mutex;
  std::condition_variable_any never;
  QueueState queue;
  while (!queue.known || queue.running + queue.waiting > 0) {
    std::unique_lock lock(mutex);
    never.wait_for(lock, session.stop, std::chrono::milliseconds(2000 + runs.size()), [] { return false; });
    if (session.stop.stop_requested()) break;
    look(runs, folder / "runs", told, session.watch);
    const QueueState now = queue_state(jobs);
    if (!now.known) continue;
    if (now.running != queue.running || now.waiting != queue.waiting)
      session.watch.log(fmt::format("queue: {} running, {} waiting", now.running, now.waiting));
    queue = now;
  }
  session.watch.end();
  if (session.stop.stop_requested())
    throw Interrupted(fmt::format("interrupted; jobs {} go on, grainlaw calibrate {} -o {} --wait waits for them",
                                  names, (tasks / "spec.json").string(), folder.string()));
  const auto code = exit_code_in(tasks);
  if (!code)
    throw Error(fmt::format("jobs {} are over without a calibration; see the logs in {}, the same command goes on",
                            names, tasks.string()));
  if (*code != 0 && *code != static_cast<int>(ExitCode::not_converged))
    throw Error(
        fmt::format("the calibration ended with exit code {}; see {}", *code, (tasks / "calibration.log").string()));
  return static_cast<ExitCode>(*code);
}

}  // namespace grainlaw::app
