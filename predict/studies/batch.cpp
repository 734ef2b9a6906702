#include "predict/studies/batch.hpp"

#include <algorithm>
#include <exception>
#include <thread>

#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {

std::vector<LawState<double>> walk_batch(const std::vector<BatchPath>& paths, Integrator integrator, double accuracy,
                                         const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                                         int threads, const RunControl& control) {
  std::vector<LawState<double>> ends(paths.size());
  const std::size_t teams = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), 1,
                                                    std::max<std::size_t>(paths.size(), 1));
  std::vector<std::exception_ptr> failures(teams);
  const auto work = [&](std::size_t team) {
    try {
      Walker walker(integrator, accuracy, parameters, rung, coupling);
      const std::size_t end = paths.size() * (team + 1) / teams;
      for (std::size_t i = paths.size() * team / teams; i < end; ++i) {
        if (control.stop.stop_requested()) throw Interrupted("the batch was interrupted");
        ends[i] = walker.walk(paths[i].segments, paths[i].start).ends.back();
      }
    } catch (...) {
      failures[team] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t team = 1; team < teams; ++team) others.emplace_back(work, team);
    work(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
  return ends;
}

}  // namespace grainlaw::predict
