#include "predict/rung_advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace grainlaw::predict {
namespace {

constexpr double kNoticed = 0.02;  // change of pressure that a law should not miss

}  // namespace

RungAdvice rung_needed(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments) {
  RungAdvice advice{Rung::reduced, "no shear, or shear at a constant volume that keeps its pressure"};
  Deviator<double> N = Deviator<double>::Zero();
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const StraightSegment& segment = segments[k];
    const LawDirection direction = path_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin));
    const bool volume = std::abs(direction.dx) > kPathNoise * direction.de, shear = direction.de > 0;
    if (shear && direction.N.dot(N) < 0) return {Rung::memory, fmt::format("segments[{}] turns the shear back", k)};
    if (volume && (shear || !N.isZero()) && advice.rung == Rung::reduced)
      advice = {Rung::evolution, fmt::format("segments[{}] changes the volume of a sheared state", k)};
    if (shear) N = direction.N;
    N = rotated(N, direction.spin, segment.length);  // the state, where shear does not hold it
    if (shear && direction.N.dot(N) < 0)
      return {Rung::memory, fmt::format("the spin of segments[{}] turns the state against its shear", k)};
    if (volume || !shear || advice.rung == Rung::memory) continue;
    const double P = parameters.isotropic.P_star(segment.nu_start),
                 rise = parameters.steady.P_star(segment.nu_start) / P - 1;
    if (std::abs(rise) > kNoticed)
      advice = {Rung::memory,
                fmt::format("shear of segments[{}] changes P* by {:+.1f} % at constant volume", k, 100 * rise)};
  }
  return advice;
}

RungRecommendation recommended_rung(const std::vector<Rehearsal>& rehearsals,
                                    const std::vector<StraightSegment>& segments, const std::vector<Rung>& rungs,
                                    const RungAdvice& needed) {
  const Spokesmen spokesmen = spokesmen_for(segments, rehearsals);
  const std::vector<RungScore> table = scores(spokesmen, rungs);
  if (table.empty()) {
    const bool there = std::ranges::find(rungs, needed.rung) != rungs.end();
    return {there ? needed.rung : rungs.back(), false,
            "by what the path contains; no path was rehearsed by these rungs"};
  }
  const RungScore& best = table.front();
  std::string why =
      fmt::format("best on {} rehearsal{} ({}), rms error of P* {:.2g} B*, stress ratio {:.2g} s_max",
                  spokesmen.rehearsals.size(), spokesmen.rehearsals.size() == 1 ? "" : "s",
                  spokesmen.of_kind ? to_string(spokesmen.kind) : "of all kinds", best.rms[0], best.rms[1]);
  if (best.rms[2] > 0) why += fmt::format(", fabric {:.2g} F_max", best.rms[2]);
  for (std::size_t i = 1; i < table.size(); ++i) {
    std::vector<std::string> times;
    for (std::size_t q = 0; q < best.rms.size(); ++q) {
      if (best.rms[q] > 0) times.push_back(fmt::format("{:.1f}", table[i].rms[q] / best.rms[q]));
    }
    if (times.empty()) continue;
    why += fmt::format("; {} errs {}{}{} times as much", to_string(table[i].rung),
                       fmt::join(times.begin(), times.end() - 1, ", "), times.size() > 1 ? " and " : "", times.back());
  }
  return {best.rung, true, why};
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
