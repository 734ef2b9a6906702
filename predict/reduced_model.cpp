// Tensor form of Eqs. (17) and (18) on a straight segment, q = sigma'/P, N the segment's direction:
//   q(e) = s_max N - (s_max N - q_0) exp(-beta_s e),   F'(e) = F_max N - (F_max N - F'_0) exp(-beta_F e)
// so that what does not lie along N decays. e is the deviatoric strain since the corner; parameters at the current nu.

#include <algorithm>

#include "model/reduced_law.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/path_states.hpp"

namespace grainlaw::predict {
namespace {

/// sigma'/P and F' at a corner.
struct Ratios {
  Deviator<double> q, F;
};

Deviator<double> saturating_tensor(const Deviator<double>& limit, const Deviator<double>& start, double rate,
                                   double e) {
  return limit - (limit - start) * std::exp(-rate * e);
}

Ratios ratios_at(const LawParameters<double>& p, const Ratios& corner, const LawDirection& direction, double nu,
                 double e) {
  const double eps_dev = direction.de * e;
  const LawModuli<double> m = along(moduli_at(p, nu), p.lode, direction);
  return {saturating_tensor(m.s_max * direction.N, corner.q, m.beta_s, eps_dev),
          saturating_tensor(m.F_max * direction.N, corner.F, m.beta_F, eps_dev)};
}

PathStates states_of(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                     const LawState<double>& start, const std::vector<OutputPoint>& points, const RunControl& control) {
  const double nu_c = parameters.isotropic.pressure.nu_c;
  const Ratios none{Deviator<double>::Zero(), Deviator<double>::Zero()};
  PathStates out;
  out.states.reserve(points.size());
  Ratios corner{start.sigma / start.P, start.F};
  bool jammed = true;
  std::size_t next = 0;
  for (std::size_t k = 0; k < segments.size() && next < points.size(); ++k) {
    const StraightSegment& segment = segments[k];
    const LawDirection direction = law_direction(segment.direction);
    // nu passes nu_c once in a segment, down where it was jammed and up where it was not
    const double crossing = std::max(std::log(nu_c / segment.nu_start) / direction.dx, 0.0);
    const bool crosses = (jammed ? direction.dx < 0 : direction.dx > 0) && crossing <= segment.length;
    const auto state_at = [&](double e) -> LawState<double> {
      const bool after = crosses && e >= crossing;
      if (jammed == after) return {0, none.q, none.F};
      const double from = after ? crossing : 0;
      const double nu = segment.nu(e), P = parameters.isotropic.P_star(nu);
      const Ratios now = ratios_at(parameters, after ? none : corner, direction, nu, e - from);
      return {P, now.q * P, now.F};
    };
    for (; next < points.size() && points[next].segment == static_cast<int>(k); ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      out.states.push_back(state_at(points[next].e));
    }
    const bool reached = next < points.size() || (!points.empty() && points.back().e >= crossing);
    if (crosses && reached)
      out.events.push_back({jammed ? EventKind::unjammed : EventKind::jammed, {static_cast<int>(k), crossing}, nu_c});
    if (jammed != crosses) {
      const double from = crosses ? crossing : 0;
      corner =
          ratios_at(parameters, crosses ? none : corner, direction, segment.nu(segment.length), segment.length - from);
    }
    jammed = jammed != crosses;
  }
  return out;
}

}  // namespace

PathStates reduced_states(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                          const PathStart& start, const std::vector<OutputPoint>& points, const RunControl& control) {
  PathStates out = states_of(parameters, segments, start.state, points, control);
  if (start.steps.empty()) return out;
  const auto unjammed = std::ranges::find_if(out.states, [](const LawState<double>& state) { return !(state.P > 0); });
  out.slopes.assign(points.size(), std::vector(start.steps.size(), unknown_slope()));
  for (std::size_t k = 0; k < start.steps.size(); ++k) {
    const auto& [magnitude, h, above, below] = start.steps[k];
    const auto up = states_of(above, segments, moved(start.state, h, start.slopes[k]), points, control).states;
    const auto down = states_of(below, segments, moved(start.state, -h, start.slopes[k]), points, control).states;
    for (std::size_t i = 0; i < static_cast<std::size_t>(unjammed - out.states.begin()); ++i) {
      out.slopes[i][k] = moved({}, 1 / (2 * h), moved(up[i], -1, down[i]));
    }
  }
  return out;
}

}  // namespace grainlaw::predict
