#pragma once
// The walk along a strain path that all rungs share, and how a state on it becomes a row. predict() checks start and points
// before and derives what rows report after.

#include <chrono>
#include <functional>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"
#include "predict/segment_sensitivity.hpp"

namespace grainlaw::predict {

/// Where a path begins, and how that moves with the parameters: one slope for each step.
struct PathStart {
  LawState<double> state;
  std::vector<ParameterStep> steps;  ///< of the parameters whose influence is wanted
  std::vector<LawState<double>> slopes;
};

/// Called at each point in their order. `state`: zero while unjammed; `slopes`: to each parameter asked for.
using PathVisitor = std::function<void(const LawState<double>& state, const std::vector<LawState<double>>& slopes)>;

/// What is known of a path at its end.
struct WalkedPath {
  std::vector<PathEvent> events;
  SolverStatistics statistics;  ///< without `seconds`
};

/// Segments, output points and events in their order. `follower` knows the law, as a closed form or an integrator:
///   enter(segment, k)  begins segments[k], where the path may turn
///   advance(e)         moves on to path parameter e of it, through the events on the way, which it notes
///   state(), slopes()  are those there; slopes none when none is asked for
///   events()           all so far
template <class Follower>
WalkedPath walk(Follower& follower, const std::vector<StraightSegment>& segments,
                const std::vector<OutputPoint>& points, const RunControl& control, const PathVisitor& visit) {
  std::size_t next = 0;
  for (std::size_t k = 0; k < segments.size() && next < points.size(); ++k) {
    follower.enter(segments[k], static_cast<int>(k));
    for (; next < points.size() && points[next].segment == static_cast<int>(k); ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      follower.advance(points[next].e);
      visit(follower.state(), follower.slopes());
    }
    if (next < points.size()) follower.advance(segments[k].length);
  }
  return {follower.events(), {}};
}

/// Eqs. (17), (18) from each corner on, P by Eq. (14). An isotropic segment keeps sigma'/P and F'. Unjams and jams at
/// nu_c, where it begins anew.
WalkedPath walk_reduced(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                        const PathStart& start, const std::vector<OutputPoint>& points, const RunControl& control,
                        const PathVisitor& visit);

/// Rung::evolution or Rung::memory, with the events of path_integration.hpp.
WalkedPath walk_integrated(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                           const std::vector<StraightSegment>& segments, const PathStart& start,
                           const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                           const RunControl& control, const PathVisitor& visit);

/// NaN throughout.
LawState<double> unknown_slope();

/// Where on a path a state is, as in PredictedRow.
struct PathPlace {
  int segment = 0;
  Strain strain;
  double shear_path = 0, nu = 0;
};

/// N: the path's first shear direction, zero without one.
PredictedRow row_of(const PathPlace& place, const LawState<double>& state, const Deviator<double>& N);

/// What follows from rows and events: where it unjammed first, the warnings, and the time since `begun`.
void conclude(Prediction& prediction, const ValidRange& range, std::chrono::steady_clock::time_point begun);

}  // namespace grainlaw::predict
