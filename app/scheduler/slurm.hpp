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

/// Writes bash scripts to `folder`/tasks and returns them in the order of running: tasks.sbatch, an array job that makes `tasks` (unless
/// there are none), and calibration.sbatch, which leaves its exit code in calibration.exit. TERM, which Slurm sends a minute before
/// the time limit, leads to a checkpoint and back into the queue, and so does the death of the program, ten times.
std::vector<std::filesystem::path> write_scripts(const std::filesystem::path& folder, const std::vector<int>& tasks,
                                                 const SlurmOptions& options);

/// Hands scripts to sbatch, each to run after the one before has succeeded; the numbers of the jobs. Throws Error with what
/// sbatch says.
std::vector<std::string> submit(const std::vector<std::filesystem::path>& scripts);

/// How many of a job's tasks are in each state.
struct QueueState {
  bool known = false;  ///< false: the controller does not answer now
  int running = 0, waiting = 0;
};

/// Of these jobs together. Jobs that are over are in no state.
QueueState queue_state(const std::vector<std::string>& jobs);

}  // namespace grainlaw::app
