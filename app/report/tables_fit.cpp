// What the fit did, and how far it can be trusted.

#include <algorithm>
#include <cmath>

#include "app/report/tables.hpp"
#include "fit/leave_one_out.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;

/// A parameter, and what becomes of it without the packing that matters most.
struct Moved {
  std::size_t index;
  double value, standard_error;
  const fit::LeftOut& furthest;
  double jackknife;
};

double best_value(const fit::Profile& profile) {
  const auto best = std::min_element(profile.points.begin(), profile.points.end(),
                                     [](const auto& a, const auto& b) { return a.excess < b.excess; });
  return best == profile.points.end() ? kUndefined : best->value;
}

Cell digits_or(double value, int count, const char* words) { return std::isnan(value) ? words : digits(value, count); }
Cell bound(double value) { return digits_or(value, 3, "not bounded"); }
Cell onset(double value) { return digits_or(value, 2, "goes on changing"); }

Cell percent(double part, double whole) { return decimals(100 * part / whole, 2); }

}  // namespace

Table stage_table(const fit::Calibration& calibration) {
  return table_of("Stages of the fit", "calibration.json", calibration.stages,
                  {{"stage", words, &fit::Stage::name},
                   {"free", number, &fit::Stage::free_parameters},
                   {"residuals", number, &fit::Stage::residuals},
                   {"iterations", number, &fit::Stage::iterations},
                   {"cost at start", number, [](auto& stage) { return digits(stage.initial_cost); }},
                   {"cost at end", number, [](auto& stage) { return digits(stage.final_cost); }},
                   {"seconds", number, [](auto& stage) { return digits(stage.seconds, 2); }},
                   {"window", words, &fit::Stage::window},
                   {"termination", words, &fit::Stage::termination}});
}

Table residual_table(const fit::Calibration& calibration) {
  const auto is_coupled = [](auto& r) { return r.in.name == "evolution" || r.in.name == "memory"; };
  return table_of("Misfit of the coupled fits per test: model minus DEM", "calibration.json",
                  each_within(calibration.stages, &fit::Stage::tests, is_coupled),
                  {{"stage", words, [](auto& r) { return r.in.name; }},
                   {"test", words, [](auto& r) { return r.it.test; }},
                   {"quantity", words, [](auto& r) { return r.it.quantity; }},
                   {"fitted", words, [](auto& r) { return r.it.in_cost ? "yes" : "shown only"; }},
                   {"rows", number, [](auto& r) { return r.it.rows; }},
                   {"left out", number, [](auto& r) { return r.it.rows_excluded; }},
                   {"RMS", number, [](auto& r) { return digits(r.it.rms, 3); }},
                   {"bias", number, [](auto& r) { return digits(r.it.bias, 3); }},
                   {"RMS/max|DEM| [%]", number, [](auto& r) { return percent(r.it.rms, r.it.max_abs_data); }},
                   {"bias/max|DEM| [%]", number, [](auto& r) { return percent(r.it.bias, r.it.max_abs_data); }}});
}

Table left_out_table(const fit::Calibration& calibration) {
  std::vector<Moved> parameters;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Estimate& estimate = calibration.law.estimates[i];
    const fit::LeftOut* furthest = fit::furthest(calibration.left_out, i, estimate.value);
    if (!std::isfinite(estimate.standard_error) || furthest == nullptr) continue;
    parameters.push_back(
        {i, estimate.value, estimate.standard_error, *furthest, fit::jackknife_error(calibration.left_out, i)});
  }
  return table_of("Without one packing: how far each parameter moves, and the error that these shifts give",
                  "calibration.json", parameters,
                  {{"parameter", words, [](auto& p) { return parameter_table()[p.index].name; }},
                   {"standard error", number, [](auto& p) { return digits(p.standard_error, 2); }},
                   {"largest shift", number, [](auto& p) { return digits(p.furthest.value[p.index] - p.value, 2); }},
                   {"without seed", number, [](auto& p) { return p.furthest.seed; }},
                   {"jackknife error", number, [](auto& p) { return digits(p.jackknife, 2); }},
                   {"jackknife/stated", number, [](auto& p) { return digits(p.jackknife / p.standard_error, 2); }}});
}

Table profile_table(const fit::Calibration& calibration) {
  return table_of("Doubtful parameters: how far they go when all others of the stage follow (95 %, likelihood profile)",
                  "calibration.json", each_within(calibration.stages, &fit::Stage::profiles),
                  {{"stage", words, [](auto& p) { return p.in.name; }},
                   {"parameter", words, [](auto& p) { return p.it.parameter; }},
                   {"why", words, [](auto& p) { return p.it.reason; }},
                   {"best", number, [](auto& p) { return digits(best_value(p.it), 3); }},
                   {"lower", number, [](auto& p) { return bound(p.it.lower); }},
                   {"upper", number, [](auto& p) { return bound(p.it.upper); }},
                   {"what would narrow it", words, [](auto& p) { return p.it.experiment; }}});
}

Table steady_table(const fit::Calibration& calibration) {
  return table_of(
      "Steady state of shear: deviatoric strain from which each quantity is steady, and from which means are taken",
      "calibration.json", calibration.shear,
      {{"test", words, &fit::ShearFit::test},
       {"{ν}", number, [](auto& shear) { return decimals(shear.nu, 3); }},
       {"{s}", number, [](auto& shear) { return onset(shear.steady_since_s); }},
       {"{F}", number, [](auto& shear) { return onset(shear.steady_since_F); }},
       {"{P}*", number, [](auto& shear) { return onset(shear.steady_since_P); }},
       {"means from", number, [](auto& shear) { return digits(shear.steady_from, 2); }},
       {"test ends at", number, [](auto& shear) { return digits(shear.eps_dev_max, 2); }}});
}

}  // namespace grainlaw::app::report
