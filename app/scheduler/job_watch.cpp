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
#include "dem/runs/task_list.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// Tells the watch which runs are finished or being made since it was told last.
class Progressing {
 public:
  Progressing(const std::vector<dem::PlannedRun>& runs, fs::path store, Watch& watch)
      : runs_(runs), store_(std::move(store)), watch_(watch), finished_(runs.size()) {
    std::vector<double> work;
    for (const dem::PlannedRun& run : runs)
      work.push_back(run.is_preparation ? expected_work(run.test->preparation) : expected_work(*run.test));
    watch_.begin(work, "particle-steps");
  }
  ~Progressing() { watch_.end(); }
  Progressing(const Progressing&) = delete;
  Progressing& operator=(const Progressing&) = delete;

  void look() {
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (finished_[i]) continue;
      if (dem::is_finished(store_, runs_[i].key)) {
        finished_[i] = true;
        watch_.finished(i);
      } else if (dem::maker_of(store_, runs_[i].key)) {
        watch_.control(i, runs_[i].name, {}).report({runs_[i].name, 0, 0, "particle-steps"});
      }
    }
  }

 private:
  const std::vector<dem::PlannedRun>& runs_;
  fs::path store_;
  Watch& watch_;
  std::vector<bool> finished_;
};

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
  const std::chrono::milliseconds pause(2000 + runs.size());
  std::mutex mutex;
  std::condition_variable_any never;
  Progressing progress(runs, folder / "runs", session.watch);
  QueueState before;
  for (QueueState now; !now.known || now.running + now.waiting > 0;) {
    std::unique_lock lock(mutex);
    never.wait_for(lock, session.stop, pause, [] { return false; });
    if (session.stop.stop_requested())
      throw Interrupted(fmt::format("interrupted; jobs {} go on, grainlaw calibrate {} -o {} --wait waits for them",
                                    names, (tasks / "spec.json").string(), folder.string()));
    progress.look();
    now = queue_state(jobs);
    if (now.known && (now.running != before.running || now.waiting != before.waiting))
      session.watch.log(fmt::format("queue: {} running, {} waiting", now.running, now.waiting));
    if (now.known) before = now;
  }
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
