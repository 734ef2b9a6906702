#pragma once
// Many independent paths over the cores. Every path is walked by itself, so the results do not depend on the threads.

#include <vector>

#include "model/vocabulary/run_control.hpp"
#include "predict/studies/walker.hpp"

namespace grainlaw::predict {

struct BatchPath {
  std::vector<StraightSegment> segments;
  LawState<double> start;  ///< jammed
};

/// State at the end of each path, in their order. `integrator` and `accuracy` as for Walker. Throws what the first
/// failing path of a thread throws, and Interrupted.
std::vector<LawState<double>> walk_batch(const std::vector<BatchPath>& paths, Integrator integrator, double accuracy,
                                         const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                                         int threads, const RunControl& control);

}  // namespace grainlaw::predict
