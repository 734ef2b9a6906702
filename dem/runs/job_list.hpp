#pragma once
// Independent jobs over the cores. A job may wait for one earlier job; jobs start in the order of the list as soon as
// they can. Threads that no waiting job can use go into the running ones' own threads. What a job yields must not
// depend on its threads or on the order of starting.

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "model/vocabulary/run_control.hpp"

namespace grainlaw::dem {

struct Job {
  std::string name;                  ///< for progress and messages
  double work = 0;                   ///< expected amount, 0 when there is nothing to do [particle-steps]
  std::optional<std::size_t> after;  ///< index of an earlier job that must be finished first
  std::function<void(int threads, const RunControl& control)> run;
};

/// Runs all jobs on `threads` threads. When one throws, the others are stopped and the first error in the order of the
/// list is rethrown; when `stop` is requested, Interrupted is thrown after all have stopped.
void run_jobs(const std::vector<Job>& jobs, int threads, Watch& watch, const std::stop_token& stop);

}  // namespace grainlaw::dem
