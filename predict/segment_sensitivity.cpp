#include "predict/segment_sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::predict {
namespace {

/// a + c b.
Unknowns moved(const double* a, double c, const double* b) {
  Unknowns sum;
  for (std::size_t i = 0; i < kUnknowns; ++i) sum[i] = a[i] + c * b[i];
  return sum;
}

Slope quotient(const Unknowns& above, const Unknowns& below, double h) {
  Slope slope;
  for (std::size_t i = 0; i < kUnknowns; ++i) slope[i] = (above[i] - below[i]) / (2 * h);
  return slope;
}

}  // namespace

std::vector<ParameterStep> parameter_steps(const LawParameters<double>& parameters,
                                           const std::vector<std::size_t>& indices) {
  std::vector<ParameterStep> steps;
  for (const std::size_t i : indices) {
    ParameterStep step{0, 0, parameters, parameters};
    const double value = *fields(parameters)[i], start = std::abs(parameter_table()[i].start);
    step.magnitude = std::max(std::abs(value), start > 0 ? start : 1.0);
    step.h = std::cbrt(std::numeric_limits<double>::epsilon()) * step.magnitude;
    *fields(step.above)[i] = value + step.h;
    *fields(step.below)[i] = value - step.h;
    steps.push_back(step);
  }
  return steps;
}

SegmentSensitivity::SegmentSensitivity(const std::vector<ParameterStep>& steps, Rung rung, Coupling coupling,
                                       const StraightSegment& segment, double P_held) {
  for (const ParameterStep& step : steps) {
    pairs_.push_back({step.h, SegmentLaw(step.above, rung, coupling, segment, P_held),
                      SegmentLaw(step.below, rung, coupling, segment, P_held)});
  }
}

void SegmentSensitivity::set(Turning turning) {
  for (Pair& pair : pairs_) {
    pair.above.set(turning);
    pair.below.set(turning);
  }
}

void SegmentSensitivity::rate(std::size_t k, double e, const double* y, const double* s, double* rate) const {
  const Pair& pair = pairs_[k];
  Unknowns above, below;
  pair.above.rate(e, moved(y, pair.h, s).data(), above.data());
  pair.below.rate(e, moved(y, -pair.h, s).data(), below.data());
  const Slope slope = quotient(above, below, pair.h);
  std::copy(slope.begin(), slope.end(), rate);
}

Slope SegmentSensitivity::of_unknowns(std::size_t k, double e, const LawState<double>& state,
                                      const Slope& slope) const {
  const Pair& pair = pairs_[k];
  const Unknowns at = packed(state);
  return quotient(pair.above.unknowns_of(e, unpacked(moved(at.data(), pair.h, slope.data()).data())),
                  pair.below.unknowns_of(e, unpacked(moved(at.data(), -pair.h, slope.data()).data())), pair.h);
}

Slope SegmentSensitivity::of_state(std::size_t k, double e, const Unknowns& y, const Slope& slope) const {
  const Pair& pair = pairs_[k];
  return quotient(packed(pair.above.state_of(e, moved(y.data(), pair.h, slope.data()).data())),
                  packed(pair.below.state_of(e, moved(y.data(), -pair.h, slope.data()).data())), pair.h);
}

Slope turned_slope(const LawState<double>& state, const Slope& slope, const LawDirection& direction) {
  LawState<double> d = unpacked(slope.data());
  d.s_r += direction.N * reversal_rate(state, d, direction);  // a slope is a rate in the parameter
  return packed(d);
}

}  // namespace grainlaw::predict
