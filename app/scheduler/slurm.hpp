#pragma once
// Slurm, as the site has it: batch scripts for the tasks of a calibration and for the calibration itself, and the programs sbatch and
// squeue. What runs when and where is Slurm's business.

#include <filesystem>
#include <string>
#include <vector>

namespace grainlaw::app {

struct SlurmOptions {
  std::string account, partition, time;  ///< as sbatch takes them; empty: the site's default
  int threads = 1;                       ///< cores of each task, and of the calibration
  std::vector<std::string> more;         ///< further options of sbatch, e.g. "--mem=4G"
};

/// Bash script of the array job that makes `tasks` of `folder`/tasks. TERM, which Slurm sends a minute before the time limit, leads to
/// a checkpoint and back into the queue, and so does the death of the program, ten times.
std::string array_script(const std::filesystem::path& folder, const std::vector<int>& tasks, const SlurmOptions& options);

/// Likewise of the calibration, which leaves its exit code in `folder`/tasks/calibration.exit.
std::string calibration_script(const std::filesystem::path& folder, const SlurmOptions& options);

/// Hands a script to sbatch, to run after the job `after` has succeeded unless that is empty; the number of the job. Throws Error with
/// what sbatch says.
std::string submit(const std::filesystem::path& script, const std::string& after);

/// How many of a job's tasks are in each state.
struct QueueState {
  bool known = false;  ///< false: the controller does not answer now
  int running = 0, waiting = 0;
};

/// Of these jobs together. Jobs that are over are in no state.
QueueState queue_state(const std::vector<std::string>& jobs);

}  // namespace grainlaw::app
