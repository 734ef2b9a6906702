// Tensor form of Eqs. (17) and (18) on a straight segment, q = sigma'/P, N the segment's direction:
//   q(e) = s_max N - (s_max N - q_0) exp(-beta_s e),   F'(e) = F_max N - (F_max N - F'_0) exp(-beta_F e)
// so that what does not lie along N decays. e is the deviatoric strain since the corner; parameters at the current nu.

#include "model/error.hpp"
#include "model/reduced_law.hpp"
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
  const double nu_c = p.shear_nu_c;
  return {
      saturating_tensor(p.stress_ratio_max.value(nu, nu_c) * direction.N, corner.q, p.stress_rate.value(nu, nu_c),
                        eps_dev),
      saturating_tensor(p.fabric_max.value(nu, nu_c) * direction.N, corner.F, p.fabric_rate.value(nu, nu_c), eps_dev)};
}

}  // namespace

PathStates reduced_states(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                          const LawState<double>& start, const std::vector<OutputPoint>& points,
                          const RunControl& control) {
  PathStates out;
  out.states.reserve(points.size());
  Ratios corner{start.sigma / start.P, start.F};
  std::size_t next = 0;
  for (std::size_t k = 0; k < segments.size() && next < points.size(); ++k) {
    const StraightSegment& segment = segments[k];
    const LawDirection direction = law_direction(segment.direction);
    const double jammed_until = jamming_point(segment, parameters.isotropic.pressure.nu_c);
    for (; next < points.size() && points[next].segment == static_cast<int>(k); ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      const double e = points[next].e;
      if (e >= jammed_until) {
        out.unjammed = true;
        out.unjammed_at = {static_cast<int>(k), jammed_until};
        return out;
      }
      const double nu = segment.nu(e);
      const Ratios now = ratios_at(parameters, corner, direction, nu, e);
      const double P = parameters.isotropic.P_star(nu);
      out.states.push_back({P, now.q * P, now.F});
    }
    if (next == points.size()) break;
    if (segment.length >= jammed_until) {
      out.unjammed = true;
      out.unjammed_at = {static_cast<int>(k), jammed_until};
      break;
    }
    corner = ratios_at(parameters, corner, direction, segment.nu(segment.length), segment.length);
  }
  return out;
}

}  // namespace grainlaw::predict
