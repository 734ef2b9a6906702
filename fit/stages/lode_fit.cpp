#include "fit/stages/lode_fit.hpp"

#include <algorithm>

#include "fit/data/shear_rows.hpp"
#include "fit/stages/evolution_fit.hpp"

namespace grainlaw::fit {

ByLodeAngle by_lode_angle(const std::vector<Trajectory>& trajectories) {
  const bool known = std::ranges::any_of(
      trajectories, [&](const Trajectory& t) { return t.constant_volume() && is_like_D2(t.direction.lode); });
  ByLodeAngle sorted;
  for (const Trajectory& t : trajectories) {
    const bool other = known && t.constant_volume() && !is_like_D2(t.direction.lode);
    (other ? sorted.others : sorted.reference).push_back(t);
  }
  return sorted;
}

StageDefinition no_lode(const std::string& why) {
  StageDefinition none = left_out("lode", parameters_of("lode"), why);
  for (NamedEstimate& e : none.absent) e.estimate.status = Status::fixed;  // at 0
  return none;
}

StageDefinition lode_stage(const std::vector<Trajectory>& others, const CalibrationOptions& options) {
  if (std::all_of(others.begin(), others.end(), [](const Trajectory& t) { return t.rows.empty(); }))
    return no_lode("taken as none: the shear has one Lode angle; add D3 to D2");
  StageDefinition stage;
  stage.name = "lode";
  stage.window = "shear at constant volume unlike D2, rows and weights of the stage evolution";
  stage.free = parameters_of("lode");
  stage.remedy = "too little shear unlike D2; shear by D3 to steady state";
  stage.blocks = [=, free = stage.free](const LawParameters<double>& law) {
    return evolution_blocks(others, law, free, options);
  };
  stage.given = {"coordination", "rattlers",   "pressure",    "stress_ratio_max",
                 "stress_rate",  "fabric_max", "fabric_rate", "anisotropy"};
  return stage;
}

}  // namespace grainlaw::fit
