#include "fit/stages/staged_laws.hpp"

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

void record(Calibration& calibration, const StageFit& fit) {
  calibration.stages.push_back(fit.stage);
  widen(calibration.errors.influence, fit.influence.cols());
  for (std::size_t k = 0; k < fit.stage.estimates.size(); ++k) {
    const NamedEstimate& e = fit.stage.estimates[k];
    const auto i = static_cast<Eigen::Index>(parameter_index(e.name)), row = static_cast<Eigen::Index>(k);
    calibration.law.estimates[static_cast<std::size_t>(i)] = e.estimate;
    calibration.errors.degrees_of_freedom(i) = e.estimate.degrees_of_freedom;
    calibration.errors.influence.row(i).setZero();
    if (row < fit.influence.rows())
      calibration.errors.influence.row(i).head(fit.influence.cols()) = fit.influence.row(row);
  }
}

void fit_unloading_laws(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                        const CalibrationOptions& options, const RunControl& control) {
  const std::string window = fmt::format("{}, nu >= {:g}", branch, options.iso_nu_min);
  LawParameters<double>& law = calibration.law.parameters;
  const std::vector<StageFit> state_law = fit_state_law("", series, window, law.isotropic, options, control);
  for (const StageFit& fit : state_law) record(calibration, fit);
  const StageFit overlap = fit_overlap(series, window, state_law.back(), law.overlap_D, options, control);
  if (overlap.solution.defined) law.overlap_D = overlap.solution.x(0);
  record(calibration, overlap);
  const StageFit trace = fit_fabric_trace(series, window, law.fabric_g3, options, control);
  law.fabric_g3 = trace.solution.x(0);
  record(calibration, trace);
}

void fit_steady_laws(Mode mode, const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                     const RunControl& control) {
  const std::vector<DensitySeries> series = steady_series(data, mode, options);
  const std::string window =
      fmt::format("means of {} over eps_dev >= {:g}, or from where it is steady (shear[]), one row per test",
                  to_string(mode), options.steady_from);
  if (!series.empty()) {
    for (const StageFit& fit :
         fit_state_law("steady_", series, window, calibration.law.parameters.steady, options, control)) {
      record(calibration, fit);
    }
    return;
  }
  const std::string remedy =
      fmt::format("no {} test reaches eps_dev = {:g}; shear further", to_string(mode), options.steady_from);
  record(calibration,
         skipped_stage("steady_coordination",
                       {"steady_coordination.C1", "steady_coordination.alpha", "steady_coordination.nu_c"}, remedy));
  record(calibration, skipped_stage("steady_rattlers", {"steady_rattlers.phi_c", "steady_rattlers.phi_v"}, remedy));
  record(calibration, skipped_stage("steady_pressure",
                                    {"steady_pressure.p0", "steady_pressure.gamma_p", "steady_pressure.nu_c"}, remedy));
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
    record(calibration, fit_density_law(quantity, of_law, cluster, calibration.law.parameters, options, control));
}

bool all_converged(const Calibration& calibration) {
  return std::all_of(calibration.stages.begin(), calibration.stages.end(),
                     [](const Stage& stage) { return stage.converged; });
}

}  // namespace grainlaw::fit
