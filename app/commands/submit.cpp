// grainlaw submit DIR --slurm: the tasks of `grainlaw runs --array` and the calibration as jobs, and how far they are.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/scheduler/job_watch.hpp"
#include "app/scheduler/slurm.hpp"
#include "app/terminal/run_list_text.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

struct SubmitOptions {
  std::filesystem::path folder;  ///< of the calibration
  SlurmOptions slurm;
  int tasks = 0;  ///< to deal the missing runs out to anew; 0: as they are
  bool to_slurm = false, dry_run = false;
};

ExitCode submit_tasks(const SubmitOptions& options, Session& session) {
  if (!options.to_slurm) throw InvalidInput("submit: give --slurm; docs/many-runs.md has lines for other schedulers");
  const std::filesystem::path folder = absolute(options.folder).lexically_normal();
  dem::TaskList list = dem::read_tasks(folder);
  if (options.tasks > 0) list = dem::write_tasks(list.spec, options.tasks, folder, session);
  std::set<int> unfinished;
  for (const dem::ListedRun& run : listing_of(list.runs, folder).missing) unfinished.insert(run.task);
  const auto scripts = write_scripts(folder, {unfinished.begin(), unfinished.end()}, options.slurm);
  OrderedJson document{{"tasks", unfinished}, {"scripts", scripts}, {"jobs", OrderedJson::array()}};
  ExitCode code = ExitCode::ok;
  if (!options.dry_run) {
    const std::vector<std::string> jobs = submit(scripts);
    document["jobs"] = jobs;
    code = watch_jobs(list.spec, folder, jobs, session);
  }
  const std::string text = options.dry_run ? scripts.front().string() : (folder / "parameters.json").string();
  print_result(session.json ? json_text(document)
                            : fmt::format("{} tasks and the calibration\n{}\n", unfinished.size(), text));
  return code;
}

/// Nothing that ends a directive or begins another one.
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
  const auto word = [&](const char* name, auto& value, const char* type, const char* description) {
    command.add_option(name, value, description)->check(one_word())->type_name(type)->allow_extra_args(false);
  };
  add_value(command, "DIR", options->folder, "DIR", "folder that grainlaw runs --array has written to")->required();
  command.add_flag("--slurm", options->to_slurm, "by sbatch of Slurm");
  word("--account", slurm.account, "NAME", "who pays");
  word("--partition", slurm.partition, "NAME", "where to");
  word("--time", slurm.time, "TIME", "limit of each start of a task, three minutes or more, e.g. 4:00:00");
  word("--sbatch", slurm.more, "OPTION", "a further option of sbatch, e.g. --sbatch=--mem=4G");
  add_number(command, "--array", options->tasks, 1, 100000, "N",
             "deal the runs that are missing now out to at most N tasks");
  add_number(command, "--cores", slurm.threads, 1, 1024, "N", "of each task, and of the calibration")
      ->capture_default_str();
  command.add_flag("--dry-run", options->dry_run, "write the scripts, submit nothing");
  return [options](Session& session) { return submit_tasks(*options, session); };
}

}  // namespace grainlaw::app
