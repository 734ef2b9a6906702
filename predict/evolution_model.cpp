// Eq. (16), with or without memory, at the points of a path.

#include "model/vocabulary/error.hpp"
#include "predict/path_integration.hpp"
#include "predict/path_states.hpp"

namespace grainlaw::predict {

PathStates integrated_states(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                             const std::vector<StraightSegment>& segments, const PathStart& start,
                             const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                             const RunControl& control) {
  PathStates out;
  out.states.reserve(points.size());
  PathIntegration integration(parameters, rung, coupling, start, tolerances);
  std::size_t next = 0;
  for (std::size_t k = 0; k < segments.size() && next < points.size(); ++k) {
    integration.enter(segments[k], k);
    for (; next < points.size() && points[next].segment == static_cast<int>(k); ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      integration.advance(points[next].e);
      out.states.push_back(integration.state());
      if (!start.steps.empty()) out.slopes.push_back(integration.slopes());
    }
    if (next < points.size()) integration.advance(segments[k].length);
  }
  out.events = integration.events();
  out.statistics = integration.statistics();
  return out;
}

}  // namespace grainlaw::predict
