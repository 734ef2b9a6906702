#pragma once
// Independent jobs over the cores. A job may wait for one earlier job, and for another process that does the same; jobs start in the
// order of the list as soon as they can. Threads that no waiting job can use go into the running ones' own threads. What a job yields must not
// depend on its threads or on the order of starting.

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "model/vocabulary/run_control.hpp"

namespace grainlaw::dem {

/// What a job finds that could start.
enum class Claim {
  mine,       ///< it is to be run here and now
  finished,   ///< there is nothing to do any more
  elsewhere,  ///< another process does it; to be asked again
};

/// Thrown by a job that has to leave its work to another process: it is asked again.
struct TakenOver {};

struct Job {
  std::string name;                  ///< for progress and messages
  double work = 0;                   ///< expected amount, 0 when there is nothing to do [particle-steps]
  std::optional<std::size_t> after;  ///< index of an earlier job that must be finished first
  std::function<void(int threads, const RunControl& control)> run;
  std::function<Claim()> claim =
      {};  ///< asked before it is run, and each second while it is done elsewhere; empty: mine
};

/// Runs all jobs on `threads` threads. When one throws, the others are stopped and the first error in the order of the
/// list is rethrown; when `stop` is requested, Interrupted is thrown after all have stopped.
void run_jobs(const std::vector<Job>& jobs, int threads, Watch& watch, const std::stop_token& stop);

}  // namespace grainlaw::dem
