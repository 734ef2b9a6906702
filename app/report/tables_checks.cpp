#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/table_cells.hpp"
#include "app/report/tables.hpp"
#include "fit/leave_one_out.hpp"

namespace grainlaw::app::report {

Table left_out_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Without one packing: how far each parameter moves, and the error that these shifts give";
  table.source = "calibration.json";
  table.columns = {words(plain("parameter")),          quantity(plain("standard error")),
                   quantity(plain("largest shift")),   quantity(plain("without seed")),
                   quantity(plain("jackknife error")), quantity(plain("jackknife/stated"))};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Estimate& estimate = calibration.law.estimates[i];
    const fit::LeftOut* furthest = fit::furthest(calibration.left_out, i, estimate.value);
    if (!std::isfinite(estimate.standard_error) || furthest == nullptr) continue;
    const double jackknife = fit::jackknife_error(calibration.left_out, i);
    table.rows.push_back({plain(parameter_table()[i].name), number(estimate.standard_error, 2),
                          number(furthest->value[i] - estimate.value, 2), plain(std::to_string(furthest->seed)),
                          number(jackknife, 2), number(jackknife / estimate.standard_error, 2)});
  }
  return table;
}

Table profile_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Doubtful parameters: how far they go when all others of the stage follow (95 %, likelihood profile)";
  table.source = "calibration.json";
  table.columns = {words(plain("stage")),
                   words(plain("parameter")),
                   words(plain("why")),
                   quantity(plain("best")),
                   quantity(plain("lower")),
                   quantity(plain("upper")),
                   words(plain("what would narrow it"))};
  const auto end = [](double value) { return std::isnan(value) ? plain("not bounded") : number(value, 3); };
  for (const fit::Stage& stage : calibration.stages) {
    for (const fit::Profile& profile : stage.profiles) {
      const auto best = std::min_element(profile.points.begin(), profile.points.end(),
                                         [](const auto& a, const auto& b) { return a.excess < b.excess; });
      table.rows.push_back({plain(stage.name), plain(profile.parameter), plain(profile.reason),
                            number(best == profile.points.end() ? kUndefined : best->value, 3), end(profile.lower),
                            end(profile.upper), plain(profile.experiment)});
    }
  }
  return table;
}

Table steady_table(const fit::Calibration& calibration) {
  Table table;
  table.caption =
      "Steady state of shear: deviatoric strain from which each quantity is steady, and from which means are taken";
  table.source = "calibration.json";
  table.columns = {words(plain("test")),           quantity(notation("{ν}")),  quantity(notation("{s}")),
                   quantity(notation("{F}")),      quantity(notation("{P}*")), quantity(plain("means from")),
                   quantity(plain("test ends at"))};
  const auto onset = [](double value) { return std::isnan(value) ? plain("goes on changing") : number(value, 2); };
  for (const fit::ShearFit& shear : calibration.shear) {
    table.rows.push_back({plain(shear.test), plain(fixed(shear.nu, 3)), onset(shear.steady_since_s),
                          onset(shear.steady_since_F), onset(shear.steady_since_P), number(shear.steady_from, 2),
                          number(shear.eps_dev_max, 2)});
  }
  return table;
}

}  // namespace grainlaw::app::report
