#include "fit/staged_laws.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "fit/data/shear_rows.hpp"
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
  const bool without_solution = stage.blocks && !fit.solution.defined;  // what stages before have found stands
  if (!without_solution) add_errors(fit, calibration.errors);
  for (const auto& [name, estimate] : fit.stage.estimates) {
    Estimate& of_law = calibration.law.estimates[parameter_index(name)];
    if (!without_solution || of_law.status == Status::not_identified) of_law = estimate;
  }
}

namespace {

/// C1, alpha, phi_c and phi_v of tests that count no contacts, as published: what is left of P is its own.
void assume_contacts(const StateLawName& of, Calibration& calibration, const CalibrationOptions& options,
                     const RunControl& control) {
  const auto field = fields(calibration.law.parameters);
  for (const std::string law : {"coordination", "rattlers"}) {
    StageDefinition stage = left_out(of.prefix + law, {}, "taken as published; " + std::string(kAddContacts));
    for (const std::string& name : parameters_of(of.prefix + law)) {
      if (name.ends_with(".nu_c")) continue;
      const std::size_t i = parameter_index(name);
      *field[i] = parameter_table()[i].published.value();
      stage.absent.push_back({name,
                              {*field[i], kUndefined, Status::fixed,
                               std::string("as published, p0 and gamma_p refer to it; ") + kAddContacts}});
    }
    run(stage, calibration, options, control);
  }
}

/// The jamming density of Eq. (11) where nobody counted contacts: the pressure's.
void tie_jamming(const StateLawName& of, Calibration& calibration) {
  const std::string prefix = of.prefix;
  const std::size_t from = parameter_index(prefix + "pressure.nu_c"),
                    to = parameter_index(prefix + "coordination.nu_c");
  const auto i = static_cast<Eigen::Index>(from), j = static_cast<Eigen::Index>(to);
  CalibratedLaw& law = calibration.law;
  law.estimates[to] = law.estimates[from];
  if (law.estimates[from].status == Status::not_identified) return;
  law.estimates[to].status = Status::tied;
  law.estimates[to].note = fmt::format("that of the stage {}pressure; {}", prefix, kAddContacts);
  (law.parameters.*of.law).coordination.nu_c = (law.parameters.*of.law).pressure.nu_c;
  calibration.errors.influence.row(j) = calibration.errors.influence.row(i);
  calibration.errors.degrees_of_freedom(j) = calibration.errors.degrees_of_freedom(i);
}

/// Eqs. (11), (12), (14), on the tests that count contacts if any does.
void fit_state_law(const StateLawName& of, const std::vector<DensitySeries>& series, std::string window,
                   Calibration& calibration, const CalibrationOptions& options, const RunControl& control) {
  const std::vector<DensitySeries> counted = with_contacts(series);
  if (counted.empty()) {
    assume_contacts(of, calibration, options, control);
    run(pressure_of_assumed_contacts(of, series, window), calibration, options, control);
    tie_jamming(of, calibration);
    return;
  }
  if (counted.size() < series.size())
    window += fmt::format(", without {} tests that count no contacts", series.size() - counted.size());
  for (const StageDefinition& stage : state_law_stages(of, counted, window)) run(stage, calibration, options, control);
}

std::string window_of(const std::string& branch, const CalibrationOptions& options) {
  return fmt::format("{}, nu >= {:g}", branch, options.iso_nu_min);
}

}  // namespace

void fit_unloading_laws(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                        const CalibrationOptions& options, const RunControl& control) {
  const std::string window = window_of(branch, options);
  fit_state_law(kUnloadingLaw, series, window, calibration, options, control);
  run(fabric_trace_stage(series, window), calibration, options, control);
}

void fit_overlap_law(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                     const CalibrationOptions& options, const RunControl& control) {
  run(overlap_stage(series, window_of(branch, options)), calibration, options, control);
}

void fit_steady_laws(Mode mode, const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                     const RunControl& control) {
  const std::vector<DensitySeries> series = steady_series(data, mode, options);
  if (!series.empty()) {
    const std::string window =
        fmt::format("means of {} over eps_dev >= {:g}, or from where it is steady (shear[]), one row per test",
                    to_string(mode), options.steady_from);
    return fit_state_law(kSteadyLaw, series, window, calibration, options, control);
  }
  const std::string remedy =
      fmt::format("no {} test reaches eps_dev = {:g}; shear further", to_string(mode), options.steady_from);
  for (const StageDefinition& stage : left_out_state_law(kSteadyLaw, remedy)) run(stage, calibration, options, control);
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
    run(density_law_stage(quantity, of_law, cluster, calibration.law.parameters.shear_nu_c, options), calibration,
        options, control);
}

void tie_errors(CalibratedLaw& law) {
  for (const std::string prefix : {"", "steady_"}) {
    const std::size_t from = parameter_index(prefix + "pressure.nu_c"),
                      to = parameter_index(prefix + "coordination.nu_c");
    if (law.estimates[to].status != Status::tied) continue;
    const auto i = static_cast<Eigen::Index>(from), j = static_cast<Eigen::Index>(to);
    law.estimates[to].standard_error = law.estimates[from].standard_error;
    law.estimates[to].degrees_of_freedom = law.estimates[from].degrees_of_freedom;
    law.covariance.row(j) = law.covariance.row(i);
    law.covariance.col(j) = law.covariance.col(i);
  }
}

bool all_converged(const Calibration& calibration) {
  const auto withdrawn = [&](const NamedEstimate& of) {
    return calibration.law.estimates[parameter_index(of.name)].status == Status::not_identified;
  };
  return std::ranges::all_of(calibration.stages, [&](const Stage& stage) {
    return stage.converged || (!stage.estimates.empty() && std::ranges::all_of(stage.estimates, withdrawn));
  });
}

}  // namespace grainlaw::fit
