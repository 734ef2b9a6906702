#include "app/scheduler/slurm.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "app/terminal/completion.hpp"
#include "dem/runs/task_list.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// "1-3,7": as --array takes numbers.
std::string ranges_of(std::vector<int> numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < numbers.size() && numbers[i + 1] == numbers[i] + 1) ++i;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[first]);
    if (i > first) text += fmt::format("-{}", numbers[i]);
  }
  return text;
}

constexpr const char* kScript = R"script(#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --cpus-per-task={threads}
#SBATCH --signal=B:TERM@60
#SBATCH --requeue
#SBATCH --output=/dev/null
{directives}exec >>{log} 2>&1
job=${{SLURM_ARRAY_JOB_ID:+${{SLURM_ARRAY_JOB_ID}}_}}${{SLURM_ARRAY_TASK_ID:-$SLURM_JOB_ID}}
echo "job $job on $(hostname) ($SLURMD_NODENAME), start $((${{SLURM_RESTART_COUNT:-0}} + 1)), $(date)"
# grainlaw keeps a checkpoint on TERM and exits with 130
trap 'kill -TERM "$pid" 2>/dev/null' TERM
{command} --threads {threads} &
pid=$!
code=0
wait "$pid" || code=$?
while kill -0 "$pid" 2>/dev/null; do code=0; wait "$pid" || code=$?; done  # the signal ends the waiting first
if ((code == 130 || code > 128 && ${{SLURM_RESTART_COUNT:-0}} < 10)); then
  for try in 1 2 3 4 5; do  # the controller may be away; a job that was cancelled is not running any more
    state=$(squeue --noheader --jobs="$job" --format=%T) || state=unknown
    [[ $state == RUNNING ]] && scontrol requeue "$job" && exit 0
    [[ $state == RUNNING || $state == unknown ]] || break
    sleep 5
  done
fi
{end}exit "$code"
)script";

std::string script(const std::string& name, const std::string& log, const std::string& command, const std::string& end,
                   std::string directives, const SlurmOptions& options) {
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) directives += fmt::format("#SBATCH {}={}\n", option, value);
  };
  add("--account", options.account);
  add("--partition", options.partition);
  add("--time", options.time);
  for (const std::string& option : options.more) directives += fmt::format("#SBATCH {}\n", option);
  return fmt::format(kScript, fmt::arg("name", name), fmt::arg("threads", options.threads),
                     fmt::arg("directives", directives), fmt::arg("log", log), fmt::arg("command", command),
                     fmt::arg("end", end));
}

struct Answer {
  int exit_code = 0;
  std::string text;  ///< standard output and error
};

/// The last line that is a number, or one and a cluster: "4711;cluster"; empty: none.
std::string job_number(const std::string& text) {
  std::istringstream lines(text);
  lines.exceptions(std::ios::badbit);
  std::string job;
  for (std::string line; std::getline(lines, line);) {
    const std::string number = line.substr(0, line.find(';'));
    if (!number.empty() && number.find_first_not_of("0123456789") == std::string::npos) job = number;
  }
  return job;
}

Answer answer_of(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");  // sites print lines of their own on either
  if (pipe == nullptr) throw Error(fmt::format("{}: cannot be run", command));
  Answer answer;
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) answer.text.append(buffer, n);
  const int status = pclose(pipe);
  answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  return answer;
}

}  // namespace

std::vector<fs::path> write_scripts(const fs::path& folder, const std::vector<int>& tasks,
                                    const SlurmOptions& options) {
  const fs::path place = folder / dem::kTasksFolder, array = place / "tasks.sbatch",
                 last = place / "calibration.sbatch";
  const std::string program = in_quotes(fs::read_symlink("/proc/self/exe").string()),
                    output = in_quotes(folder.string());
  std::vector<fs::path> scripts;
  fs::remove(array);
  if (!tasks.empty()) {
    write_durably(array, script("grainlaw-runs", in_quotes((place / "task-").string()) + "\"$SLURM_ARRAY_TASK_ID\".log",
                                fmt::format("{} task {} \"$SLURM_ARRAY_TASK_ID\"", program, output), "",
                                fmt::format("#SBATCH --array={}\n", ranges_of(tasks)), options));
    scripts.push_back(array);
  }
  write_durably(
      last, script("grainlaw-calibrate", in_quotes((place / "calibration.log").string()),
                   fmt::format("{} calibrate {} -o {}", program, in_quotes((place / "spec.json").string()), output),
                   fmt::format("echo \"$code\" >{}\n", in_quotes((place / "calibration.exit").string())), "", options));
  scripts.push_back(last);
  return scripts;
}

std::vector<std::string> submit(const std::vector<fs::path>& scripts) {
  std::vector<std::string> jobs;
  fs::remove(scripts.back().parent_path() / "calibration.exit");
  for (const fs::path& script : scripts) {
    const std::string after =
        jobs.empty() ? "" : fmt::format("--dependency=afterok:{} --kill-on-invalid-dep=yes ", jobs.back());
    const Answer answer = answer_of(fmt::format("sbatch --parsable {}{}", after, in_quotes(script.string())));
    const std::string job = answer.exit_code == 0 ? job_number(answer.text) : "";
    if (job.empty())
      throw Error(fmt::format(
          "{}: sbatch does not take it: {}{}", script.string(), one_line(answer.text, 300),
          jobs.empty() ? ""
                       : fmt::format("; job {} waits already, scancel it before another try", fmt::join(jobs, ", "))));
    jobs.push_back(job);
  }
  return jobs;
}

QueueState queue_state(const std::vector<std::string>& jobs) {
  const Answer answer = answer_of("squeue --me --noheader --array --format='%F %T'");
  QueueState state{answer.exit_code == 0};
  std::istringstream lines(answer.text);
  lines.exceptions(std::ios::badbit);
  for (std::string job, word; lines >> job >> word;) {
    if (std::find(jobs.begin(), jobs.end(), job) == jobs.end()) continue;
    ++(word == "PENDING" || word.starts_with("REQUEUE") ? state.waiting : state.running);
  }
  return state;
}

}  // namespace grainlaw::app
