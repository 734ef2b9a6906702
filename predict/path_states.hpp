#pragma once
// The rungs of the law as functions from a strain path to the states at the wanted points. What predict() wraps: it has
// checked start and points before and derives the reported quantities after.

#include <cmath>
#include <limits>

#include "predict/predict.hpp"
#include "predict/segment_sensitivity.hpp"

namespace grainlaw::predict {

struct PathStates {
  std::vector<LawState<double>> states;               ///< one for each point, in their order; zero while unjammed
  std::vector<std::vector<LawState<double>>> slopes;  ///< [point][k] as in Prediction; none when none is asked for
  std::vector<PathEvent> events;
  SolverStatistics statistics;  ///< without `seconds`
};

/// Where a path begins, and how that moves with the parameters: one slope for each step.
struct PathStart {
  LawState<double> state;
  std::vector<ParameterStep> steps;  ///< of the parameters whose influence is wanted
  std::vector<LawState<double>> slopes;
};

/// NaN throughout.
LawState<double> unknown_slope();

/// One line for each way in which `rows` leave `range`, naming the farthest row, and for the first event of a kind.
std::vector<std::string> warnings_of(const std::vector<PredictedRow>& rows, const std::vector<PathEvent>& events,
                                     const ValidRange& range);

/// Path parameter at which nu of `segment` falls to `nu_jamming`; infinite when its volume does not grow.
inline double jamming_point(const StraightSegment& segment, double nu_jamming) {
  const double dilation = segment.eps_vol_rate();
  if (!(dilation > 0)) return std::numeric_limits<double>::infinity();
  return std::log(segment.nu_start / nu_jamming) / dilation;
}

/// Eqs. (17), (18) from each corner on, P by Eq. (14). An isotropic segment keeps sigma'/P and F'. Unjams and jams at
/// nu_c, where it begins anew.
PathStates reduced_states(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                          const PathStart& start, const std::vector<OutputPoint>& points, const RunControl& control);

/// Rung::evolution or Rung::memory, with the events of path_integration.hpp.
PathStates integrated_states(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                             const std::vector<StraightSegment>& segments, const PathStart& start,
                             const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                             const RunControl& control);

}  // namespace grainlaw::predict
