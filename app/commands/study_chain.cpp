#include "app/commands/study_chain.hpp"

#include <fmt/format.h>

#include <optional>

#include "model/files/output_folder.hpp"
#include "chain/studies/calibrated_setting.hpp"
#include "app/report/figure_study.hpp"
#include "chain/studies/reference_by_packings.hpp"
#include "chain/studies/spec_settings.hpp"
#include "chain/studies/study_json.hpp"
#include "app/commands/study_output.hpp"
#include "app/commands/study_table.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kErrorOfPrediction =
    "root mean square over P_star, s_par, F_par of their differences from the reference's prediction, root mean square "
    "along the path over the largest value";

}  // namespace

ExitCode study_chain(const StudyChainOptions& options, Session& session) {
  const std::vector<chain::SpecSetting> settings = chain::settings_of(options.spec, options.reference, options.vary);
  const Path path = chain::study_path(options.path);
  const std::size_t judged = options.reference.empty() ? 0 : 1;
  make_output_folder(options.output);
  std::vector<double> densities;  // of the first setting, the reference
  std::optional<chain::ReferenceByPackings> reference;
  const auto show = [&](const chain::SpecSetting& setting) {
    const Dataset dataset = chain::run_setting(setting, options.output, session);
    if (!reference) densities = chain::shear_densities(dataset);
    fit::CalibrationOptions fit_options;
    fit_options.threads = session.threads;
    fit_options.coupling = value_of<Coupling>(setting.spec.coupling, "coupling");
    chain::SettingOutcome outcome =
        chain::calibrated_setting(setting.name, setting.changes, dataset, fit_options, densities, path, session);
    if (reference) {
      outcome.compared_with = reference->quantities(dataset, session);
    } else if (outcome.model.empty()) {
      throw InvalidInput(fmt::format("{}: predicts nothing to compare with: {}", setting.name, outcome.note));
    } else {
      reference.emplace(dataset, outcome, fit_options, densities, path);
    }
    return outcome;
  };
  const std::vector<chain::SettingOutcome> outcomes = chain::outcomes_of(settings, judged, session, show);
  const chain::SettingsStudy study = chain::study_of("chain", kErrorOfPrediction, chain::Packings::chosen,
                                       Json(dem::spec_to_json(settings[judged].spec)), outcomes, judged);
  finish_study(options.output, chain::study_to_json(study), "settings.svg", report::figure_of(study), study_table(study),
               session);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
