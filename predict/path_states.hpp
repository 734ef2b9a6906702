#pragma once
// The rungs of the law as functions from a strain path to the states at the wanted points. What predict() wraps: it has
// checked start and points before and derives the reported quantities after.

#include <cmath>
#include <limits>

#include "predict/predict.hpp"

namespace grainlaw::predict {

struct PathStates {
  std::vector<LawState<double>> states;  ///< one for each point reached, in their order
  bool unjammed = false;                 ///< the states end because P or nu fell to that of jamming
  OutputPoint unjammed_at;               ///< where, when `unjammed`
  SolverStatistics statistics;           ///< without `seconds`
};

/// Path parameter at which nu of `segment` falls to `nu_jamming`; infinite when its volume does not grow.
inline double jamming_point(const StraightSegment& segment, double nu_jamming) {
  const double dilation = segment.eps_vol_rate();
  if (!(dilation > 0)) return std::numeric_limits<double>::infinity();
  return std::log(segment.nu_start / nu_jamming) / dilation;
}

/// Eqs. (17), (18) from each corner on, P by Eq. (14). An isotropic segment keeps sigma'/P and F'.
PathStates reduced_states(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                          const LawState<double>& start, const std::vector<OutputPoint>& points,
                          const RunControl& control);

/// Rung::evolution or Rung::memory. Unjams where P falls to 1e-12 of its start; evolution also where nu falls to the
/// jamming density of Eq. (14), which memory may pass.
PathStates integrated_states(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                             const std::vector<StraightSegment>& segments, const LawState<double>& start,
                             const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                             const RunControl& control);

}  // namespace grainlaw::predict
