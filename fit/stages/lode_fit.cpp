#include "fit/stages/lode_fit.hpp"

#include <algorithm>
#include <cmath>

namespace grainlaw::fit {
namespace {

const std::vector<std::string> kGivenToLode{"coordination", "rattlers",   "pressure",    "stress_ratio_max",
                                            "stress_rate",  "fabric_max", "fabric_rate", "anisotropy"};

StageFit no_effect() {
  StageFit fit = skipped_stage("lode", lode_parameters(), "taken as none: the shear has one Lode angle; add D3 to D2");
  for (NamedEstimate& e : fit.stage.estimates) {
    e.estimate.status = Status::fixed;
    e.estimate.value = 0;
  }
  return fit;
}

}  // namespace

bool is_like_D2(double lode) { return std::abs(lode) < 0.5; }

std::vector<std::string> lode_parameters() { return {"lode.stress_ratio", "lode.fabric"}; }

ByLodeAngle by_lode_angle(const std::vector<Trajectory>& trajectories) {
  const auto constant_volume = [](const Trajectory& t) {
    return std::abs(t.direction.dx) <= 1e-12 && t.direction.de > 0;
  };
  const bool known = std::any_of(trajectories.begin(), trajectories.end(), [&](const Trajectory& t) {
    return constant_volume(t) && is_like_D2(t.direction.lode);
  });
  ByLodeAngle sorted;
  for (const Trajectory& t : trajectories) {
    const bool other = known && constant_volume(t) && !is_like_D2(t.direction.lode);
    (other ? sorted.others : sorted.reference).push_back(t);
  }
  return sorted;
}

StageFit fit_lode(const std::vector<Trajectory>& others, LawParameters<double>& law, const CalibrationOptions& options,
                  const RunControl& control, const FoundErrors& found) {
  if (std::all_of(others.begin(), others.end(), [](const Trajectory& t) { return t.rows.empty(); })) return no_effect();
  const std::vector<std::string> free = lode_parameters();
  const EvolutionProblem problem = evolution_problem(others, law, free, options);
  StageFit fit =
      fit_stage("lode", "shear at constant volume unlike D2, rows and weights of the stage evolution",
                problem.parameters, problem.blocks, "too little shear unlike D2; shear by D3 to steady state",
                options.threads, control, {options.loss});
  if (!fit.solution.defined) return fit;
  law.lode = {fit.solution.x(0), fit.solution.x(1)};
  inherit_error(
      kGivenToLode, found, law,
      [&](const LawParameters<double>& given) { return evolution_problem(others, given, free, options).blocks; },
      options.threads, fit);
  return fit;
}

}  // namespace grainlaw::fit
