#include "predict/rung_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::predict {
namespace {

constexpr double kNoticed = 0.02;   // change of pressure that a law should not miss
constexpr double kNoStrain = 1e-9;  // strain per unit of the path parameter that is none

}  // namespace

RungAdvice rung_needed(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments) {
  RungAdvice advice{Rung::reduced, "no shear, or shear at a constant volume that keeps its pressure"};
  Deviator<double> N = Deviator<double>::Zero();
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const StraightSegment& segment = segments[k];
    const LawDirection direction = law_direction(segment.direction);
    const bool volume = std::abs(direction.dx) > kNoStrain;
    if (direction.de > 0 && direction.N.dot(N) < 0)
      return {Rung::memory, fmt::format("segments[{}] turns the shear back", k)};
    if (volume && (direction.de > 0 || !N.isZero()) && advice.rung == Rung::reduced)
      advice = {Rung::evolution, fmt::format("segments[{}] changes the volume of a sheared state", k)};
    if (direction.de > 0) N = direction.N;
    if (volume || direction.de == 0 || advice.rung == Rung::memory) continue;
    const double P = parameters.isotropic.P_star(segment.nu_start),
                 rise = parameters.steady.P_star(segment.nu_start) / P - 1;
    if (std::abs(rise) > kNoticed)
      advice = {Rung::memory,
                fmt::format("shear of segments[{}] changes P* by {:+.1f} % at constant volume", k, 100 * rise)};
  }
  return advice;
}

RungDifference difference(const Prediction& cheaper, const Prediction& richer) {
  RungDifference largest;
  for (std::size_t i = 0; i < std::min(cheaper.rows.size(), richer.rows.size()); ++i) {
    const LawState<double>&a = cheaper.rows[i].state, &b = richer.rows[i].state;
    if (!(a.P > 0 && b.P > 0)) continue;  // unjammed: no ratio to compare
    largest.P = std::max(largest.P, std::abs(b.P / a.P - 1));
    largest.s = std::max(largest.s, (b.sigma / b.P - a.sigma / a.P).norm());
    largest.F = std::max(largest.F, (b.F - a.F).norm());
  }
  return largest;
}

}  // namespace grainlaw::predict
