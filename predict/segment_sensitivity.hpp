#pragma once
// What the parameters change of a state along a straight segment, S_k = dy/dp_k for each parameter p_k, with
//   dS_k/de = (df/dy) S_k + df/dp_k = [f(y + h S_k; p_k + h) - f(y - h S_k; p_k - h)]/(2h)
// f the rate of segment_law.hpp (docs/theory/bands.md, section Slopes). CVODES' own differences step by the square root of
// its tolerance, at the default one ten times as far: far for a nu_c near jamming. They end
// where the state unjams: see RowSlope.

#include <cstddef>
#include <vector>

#include "predict/segment_law.hpp"

namespace grainlaw::predict {

/// The law with one parameter a little larger and a little smaller: df/dp = (f(p + h) - f(p - h))/(2h).
struct ParameterStep {
  double magnitude = 0;                ///< of the parameter: its value, or where a fit would start if that is larger
  double h = 0;                        ///< step [-]
  LawParameters<double> above, below;  ///< with p + h and p - h
};

/// One for each index in parameter_table().
std::vector<ParameterStep> parameter_steps(const LawParameters<double>& parameters,
                                           const std::vector<std::size_t>& indices);

/// A slope d/dp of a state, packed(), or of the unknowns.
using Slope = Unknowns;

class SegmentSensitivity {
 public:
  /// As SegmentLaw, with the steps of the parameters that are wanted. The arguments must outlive the object.
  SegmentSensitivity(const std::vector<ParameterStep>& steps, Rung rung, Coupling coupling,
                     const StraightSegment& segment, double P_held);

  /// As of SegmentLaw.
  void set(Turning turning);

  /// dS_k/de at unknowns `y` and slope `s`, into `rate`.
  void rate(std::size_t k, double e, const double* y, const double* s, double* rate) const;

  /// Slope of the unknowns where the state has slope `slope`.
  Slope of_unknowns(std::size_t k, double e, const LawState<double>& state, const Slope& slope) const;

  /// Slope of the state where the unknowns have slope `slope`.
  Slope of_state(std::size_t k, double e, const Unknowns& y, const Slope& slope) const;

 private:
  struct Pair {
    double h;
    SegmentLaw above, below;
  };
  std::vector<Pair> pairs_;
};

/// Slope of `state` after reverse(), at a corner of the path or where s_r begins to follow s on the way: also where that
/// place moves with the parameters, since only the rate of s_r along N jumps there.
Slope turned_slope(const LawState<double>& state, const Slope& slope, const LawDirection& direction);

}  // namespace grainlaw::predict
