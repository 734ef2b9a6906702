// grainlaw submit DIR --slurm: the tasks of `grainlaw runs --array` as an array job, the calibration after it, and how far they are.

#include <fmt/format.h>

#include <set>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/scheduler/job_watch.hpp"
#include "app/scheduler/slurm.hpp"
#include "app/terminal/run_list_text.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

struct SubmitOptions {
  std::filesystem::path folder;  ///< of the calibration
  SlurmOptions slurm;
  int tasks = 0;  ///< to deal the missing runs out to anew; 0: as they are
  bool to_slurm = false, dry_run = false;
};

/// The list as it is, or the runs that are missing now dealt out anew.
dem::TaskList task_list(const SubmitOptions& options, const Session& session) {
  dem::TaskList list = dem::read_tasks(options.folder);
  if (options.tasks == 0) return list;
  const std::vector<dem::PlannedTest> tests = plan(list.spec);
  list.runs = listing_of(dem::listed(dem::runs_of(tests)), options.folder).missing;
  dem::deal(list.runs, options.tasks);
  dem::write_tasks(list, options.folder, session);
  return list;
}

/// Those with something to do.
std::vector<int> unfinished_tasks(const dem::TaskList& list, const std::filesystem::path& folder) {
  std::set<int> tasks;
  for (const dem::ListedRun& run : listing_of(list.runs, folder).missing) tasks.insert(run.task);
  return {tasks.begin(), tasks.end()};
}

ExitCode submit_tasks(const SubmitOptions& options, Session& session) {
  if (!options.to_slurm) throw InvalidInput("submit: give --slurm; docs/many-runs.md has lines for other schedulers");
  const dem::TaskList list = task_list(options, session);
  const std::filesystem::path folder = absolute(options.folder).lexically_normal(), tasks = folder / dem::kTasksFolder;
  const std::vector<int> unfinished = unfinished_tasks(list, folder);
  const std::filesystem::path array = tasks / "tasks.sbatch", calibration = tasks / "calibration.sbatch";
  std::filesystem::remove(array);
  if (!unfinished.empty()) write_durably(array, array_script(folder, unfinished, options.slurm));
  write_durably(calibration, calibration_script(folder, options.slurm));
  OrderedJson document{{"tasks", unfinished}, {"scripts", OrderedJson::array()}, {"jobs", OrderedJson::array()}};
  if (!unfinished.empty()) document["scripts"].push_back(array.string());
  document["scripts"].push_back(calibration.string());
  ExitCode code = ExitCode::ok;
  std::string text = fmt::format("{} tasks and the calibration\n", unfinished.size());
  if (!options.dry_run) {
    std::filesystem::remove(tasks / "calibration.exit");
    std::vector<std::string> jobs;
    if (!unfinished.empty()) jobs.push_back(submit(array, ""));
    jobs.push_back(submit(calibration, jobs.empty() ? "" : jobs.back()));
    document["jobs"] = jobs;
    code = watch_jobs(list.spec, folder, jobs, session);
    text = fmt::format("{}\n", (folder / "parameters.json").string());
  } else {
    for (const auto& script : document["scripts"]) text += fmt::format("{}\n", script.get<std::string>());
  }
  print_result(session.json ? json_text(document) : text);
  return code;
}

/// One line without what a directive would take for its end.
CLI::Validator one_word() {
  return {[](const std::string& text) {
            const bool sound = !text.empty() && text.find_first_of(" \t\r\n#'\"\\") == std::string::npos;
            return sound ? std::string() : std::string("give one word without quotes");
          },
          "", ""};
}

}  // namespace

Task declare_submit(CLI::App& command) {
  const auto options = std::make_shared<SubmitOptions>();
  SlurmOptions& slurm = options->slurm;
  command.add_option("DIR", options->folder, "folder that grainlaw runs --array has written to")
      ->required()
      ->type_name("DIR");
  command.add_flag("--slurm", options->to_slurm, "by sbatch of Slurm");
  command.add_option("--account", slurm.account, "who pays")->check(one_word())->type_name("NAME");
  command.add_option("--partition", slurm.partition, "where to")->check(one_word())->type_name("NAME");
  command.add_option("--time", slurm.time, "limit of each start of a task, three minutes or more, e.g. 4:00:00")
      ->check(one_word())
      ->type_name("TIME");
  command.add_option("--array", options->tasks, "deal the runs that are missing now out to at most N tasks")
      ->check(between(1, 100000))
      ->type_name("N");
  command.add_option("--cores", slurm.threads, "of each task, and of the calibration")
      ->check(between(1, 1024))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--sbatch", slurm.more, "a further option of sbatch, e.g. --sbatch=--mem=4G")
      ->check(one_word())
      ->type_name("OPTION");
  command.add_flag("--dry-run", options->dry_run, "write the scripts, submit nothing");
  return [options](Session& session) { return submit_tasks(*options, session); };
}

}  // namespace grainlaw::app
