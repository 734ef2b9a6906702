#include "fit/staged_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "fit/stages/density_fit.hpp"
#include "fit/stages/density_law_fit.hpp"
#include "fit/stages/lode_fit.hpp"
#include "fit/stages/shear_fit.hpp"

namespace grainlaw::fit {

Calibration nothing_known() {
  Calibration calibration;
  calibration.law.parameters = start_parameters();
  calibration.errors = no_errors();
  calibration.law.covariance = calibration.errors.covariance();
  calibration.law.estimates[parameter_index("shear.nu_c")] = {
      calibration.law.parameters.shear_nu_c, kUndefined, Status::fixed, "degenerate with Q_c and alpha of Eq. (20)"};
  return calibration;
}

void run(const StageDefinition& stage, Calibration& calibration, const CalibrationOptions& options,
         const RunControl& control) {
  const StageFit fit = run_stage(stage, calibration.law.parameters, options, control, calibration.errors);
  calibration.stages.push_back(fit.stage);
  add_errors(fit, calibration.errors);
  for (const auto& [name, estimate] : fit.stage.estimates) calibration.law.estimates[parameter_index(name)] = estimate;
}

void fit_unloading_laws(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                        const CalibrationOptions& options, const RunControl& control) {
  const std::string window = fmt::format("{}, nu >= {:g}", branch, options.iso_nu_min);
  const auto next = [&](const StageDefinition& stage) { run(stage, calibration, options, control); };
  for (const StageDefinition& stage : state_law_stages(kUnloadingLaw, series, window)) next(stage);
  next(overlap_stage(series, window, calibration.law.parameters.isotropic.pressure.nu_c));
  next(fabric_trace_stage(series, window));
}

void fit_steady_laws(Mode mode, const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                     const RunControl& control) {
  const std::vector<DensitySeries> series = steady_series(data, mode, options);
  const std::vector<StageDefinition> stages =
      series.empty()
          ? left_out_state_law(kSteadyLaw, fmt::format("no {} test reaches eps_dev = {:g}; shear further",
                                                       to_string(mode), options.steady_from))
          : state_law_stages(kSteadyLaw, series,
                             fmt::format("means of {} over eps_dev >= {:g}, or from where it is steady (shear[]), one "
                                         "row per test",
                                         to_string(mode), options.steady_from));
  for (const StageDefinition& stage : stages) run(stage, calibration, options, control);
}

void fit_shear_laws(const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                    const RunControl& control) {
  Stage stage;
  calibration.shear =
      fit_shear_tests(data, calibration.law.parameters.isotropic.pressure.nu_c, options, control, stage);
  calibration.stages.push_back(stage);
  const std::vector<ShearFit>& shear = calibration.shear;
  const bool any_like_D2 =
      std::any_of(shear.begin(), shear.end(), [](const ShearFit& fit) { return is_like_D2(fit.lode); });
  std::vector<ShearFit> of_law;
  std::vector<int> cluster;
  for (std::size_t i = 0; i < shear.size(); ++i) {
    if (any_like_D2 && !is_like_D2(shear[i].lode)) continue;
    of_law.push_back(shear[i]);
    cluster.push_back(packing_of(data, *data.pure_shear[i]));
  }
  for (const ShearQuantity& quantity : kShearQuantities)
    run(density_law_stage(quantity, of_law, cluster, calibration.law.parameters.shear_nu_c, options), calibration, options,
        control);
}

bool all_converged(const Calibration& calibration) {
  return std::all_of(calibration.stages.begin(), calibration.stages.end(),
                     [](const Stage& stage) { return stage.converged; });
}

}  // namespace grainlaw::fit
