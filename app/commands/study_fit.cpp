#include "app/commands/study_fit.hpp"

#include <fmt/format.h>

#include "dem/runs/spec_file.hpp"
#include "model/files/output_folder.hpp"
#include "model/files/adopted_dataset.hpp"
#include "chain/studies/calibrated_setting.hpp"
#include "app/report/figure_study.hpp"
#include "chain/studies/fit_choices.hpp"
#include "chain/studies/reference_by_packings.hpp"
#include "chain/studies/study_json.hpp"
#include "app/commands/study_output.hpp"
#include "app/commands/study_table.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kOfLaws =
    "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the relative "
    "difference from the fit of everything";
constexpr const char* kOfPrediction =
    "root mean square over P_star, s_par, F_par of their differences from the prediction by the fit of everything, "
    "root mean square along the path over the largest value";

struct FitSetting {
  std::string name;
  chain::Changes changes;
  chain::FitChoice choice;
};

chain::FitChoice everything_in(const std::filesystem::path& folder, int threads) {
  chain::FitChoice choice{read_dataset(folder), {}};
  std::erase_if(choice.dataset.tests, [](const DatasetTest& test) { return test.record.role != Role::calibration; });
  if (chain::packings_of(choice.dataset).size() < 2)
    throw InvalidInput(fmt::format("{}: one packing has no scatter; give a data set of two or more", folder.string()));
  choice.options.threads = threads;
  if (!choice.dataset.spec.is_null())
    choice.options.coupling =
        value_of<Coupling>(
            dem::spec_from_json(choice.dataset.spec, (folder / "dataset.json").string() + ": spec").coupling, "coupling");
  return choice;
}

/// The fit of everything first. Throws before anything is fitted.
std::vector<FitSetting> settings_of(const chain::FitChoice& everything, std::vector<std::string> vary) {
  if (vary.empty()) vary = chain::usual_choices(everything.dataset);
  std::vector<FitSetting> settings{{"everything", {}, everything}};
  for (const std::string& text : vary) {
    const chain::Changes changes{chain::change_from(text)};
    settings.push_back({text, changes, chosen(everything, changes)});
  }
  return settings;
}

}  // namespace

ExitCode study_fit(const StudyFitOptions& options, Session& session) {
  const std::filesystem::path folder = dataset_folder(options.dataset);
  const chain::FitChoice everything = everything_in(folder, session.threads);
  const std::optional<Path> path = options.path.empty() ? std::nullopt : std::optional(chain::study_path(options.path));
  const std::vector<FitSetting> settings = settings_of(everything, options.vary);
  make_output_folder(options.output);
  const std::vector<double> densities = chain::shear_densities(everything.dataset);
  std::vector<chain::SettingOutcome> outcomes;
  std::optional<chain::ReferenceByPackings> reference;
  for (const FitSetting& setting : settings) {
    session.watch.log("setting " + setting.name);
    outcomes.push_back(chain::calibrated_setting(setting.name, setting.changes, setting.choice.dataset, setting.choice.options,
                                          densities, path, session));
    chain::SettingOutcome& outcome = outcomes.back();
    if (reference) {
      outcome.compared_with = reference->quantities(setting.choice.dataset, session);
    } else if (path ? outcome.model.empty() : outcome.quantities.empty()) {
      throw InvalidInput(fmt::format("{}: shows nothing to compare with: {}", folder.string(), outcome.note));
    } else {
      reference.emplace(setting.choice.dataset, outcome, setting.choice.options, densities, path);
    }
  }
  const chain::SettingsStudy study =
      chain::study_of("fit", path ? kOfPrediction : kOfLaws, chain::Packings::chosen,
               {{"dataset_digest", everything.dataset.digest}, {"coupling", to_string(everything.options.coupling)}},
               outcomes, 0);
  finish_study(options.output, chain::study_to_json(study), "settings.svg", report::figure_of(study), study_table(study),
               session);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
