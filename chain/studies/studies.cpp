#include "chain/studies/studies.hpp"

#include <fmt/format.h>

#include "chain/studies/calibrated_setting.hpp"
#include "chain/studies/fit_choices.hpp"
#include "chain/studies/law_quantities.hpp"
#include "model/files/dataset.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr const char* kErrorOfPackings =
    "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the difference "
    "from the reference, mean over packings, each over its chance: the standard error of that difference";

constexpr const char* kErrorOfPrediction =
    "root mean square over P_star, s_par, F_par of their differences from the reference's prediction, root mean square "
    "along the path over the largest value";

constexpr const char* kOfLaws =
    "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the relative "
    "difference from the fit of everything";
constexpr const char* kOfPrediction =
    "root mean square over P_star, s_par, F_par of their differences from the prediction by the fit of everything, "
    "root mean square along the path over the largest value";

struct FitSetting {
  std::string name;
  Changes changes;
  FitChoice choice;
};

FitChoice everything_in(const std::filesystem::path& folder, int threads) {
  FitChoice choice{read_dataset(folder), {}};
  std::erase_if(choice.dataset.tests, [](const DatasetTest& test) { return test.record.role != Role::calibration; });
  if (packings_of(choice.dataset).size() < 2)
    throw InvalidInput(fmt::format("{}: one packing has no scatter; give a data set of two or more", folder.string()));
  choice.options.threads = threads;
  if (!choice.dataset.spec.is_null())
    choice.options.coupling = value_of<Coupling>(
        dem::spec_from_json(choice.dataset.spec, (folder / "dataset.json").string() + ": spec").coupling, "coupling");
  return choice;
}

/// The fit of everything first. Throws before anything is fitted.
std::vector<FitSetting> settings_of(const FitChoice& everything, std::vector<std::string> vary) {
  if (vary.empty()) vary = usual_choices(everything.dataset);
  std::vector<FitSetting> settings{{"everything", {}, everything}};
  for (const std::string& text : vary) {
    const Changes changes{change_from(text)};
    settings.push_back({text, changes, chosen(everything, changes)});
  }
  return settings;
}

}  // namespace

SettingsStudy study_engine(const std::vector<SpecSetting>& settings, const std::filesystem::path& output,
                           const Execution& execution) {
  const SpecSetting& base = settings[1];
  for (const SpecSetting& setting : settings) {
    if (setting.spec.seeds != base.spec.seeds)
      throw InvalidInput(
          fmt::format("{}: seeds are what settings are compared over; leave them as they are", setting.name));
  }
  make_output_folder(output);
  const auto show = [&](const SpecSetting& setting) -> SettingOutcome {
    const Dataset dataset = run_setting(setting, output, execution);
    const std::vector<std::uint64_t> seeds = packings_of(dataset);
    return {setting.name,
            setting.changes,
            cost_of(dataset),
            seeds,
            packing_quantities(dataset, seeds),
            {},
            energy_residual_of(dataset),
            "",
            ""};
  };
  return study_of("dem", kErrorOfPackings, Packings::given, Json(dem::spec_to_json(base.spec)),
                  outcomes_of(settings, 1, execution, show), 1);
}

SettingsStudy study_chain(const std::vector<SpecSetting>& settings, std::size_t judged, const Path& path,
                          const std::filesystem::path& output, const Execution& execution) {
  make_output_folder(output);
  std::vector<double> densities;  // of the first setting, the reference
  std::optional<ReferenceByPackings> reference;
  const auto show = [&](const SpecSetting& setting) {
    const Dataset dataset = run_setting(setting, output, execution);
    if (!reference) densities = shear_densities(dataset);
    fit::CalibrationOptions fit_options;
    fit_options.threads = execution.threads;
    fit_options.coupling = value_of<Coupling>(setting.spec.coupling, "coupling");
    SettingOutcome outcome =
        calibrated_setting(setting.name, setting.changes, dataset, fit_options, densities, path, execution);
    if (reference) {
      outcome.compared_with = reference->quantities(dataset, execution);
    } else if (outcome.model.empty()) {
      throw InvalidInput(fmt::format("{}: predicts nothing to compare with: {}", setting.name, outcome.note));
    } else {
      reference.emplace(dataset, outcome, fit_options, densities, path);
    }
    return outcome;
  };
  const std::vector<SettingOutcome> outcomes = outcomes_of(settings, judged, execution, show);
  return study_of("chain", kErrorOfPrediction, Packings::chosen, Json(dem::spec_to_json(settings[judged].spec)),
                  outcomes, judged);
}

SettingsStudy study_fit(const std::filesystem::path& dataset, const std::optional<Path>& path,
                        const std::vector<std::string>& vary, const std::filesystem::path& output,
                        const Execution& execution) {
  const std::filesystem::path folder = dataset_folder(dataset);
  const FitChoice everything = everything_in(folder, execution.threads);
  const std::vector<FitSetting> settings = settings_of(everything, vary);
  make_output_folder(output);
  const std::vector<double> densities = shear_densities(everything.dataset);
  std::vector<SettingOutcome> outcomes;
  std::optional<ReferenceByPackings> reference;
  for (const FitSetting& setting : settings) {
    execution.watch.log("setting " + setting.name);
    outcomes.push_back(calibrated_setting(setting.name, setting.changes, setting.choice.dataset, setting.choice.options,
                                          densities, path, execution));
    SettingOutcome& outcome = outcomes.back();
    if (reference) {
      outcome.compared_with = reference->quantities(setting.choice.dataset, execution);
    } else if (path ? outcome.model.empty() : outcome.quantities.empty()) {
      throw InvalidInput(fmt::format("{}: shows nothing to compare with: {}", folder.string(), outcome.note));
    } else {
      reference.emplace(setting.choice.dataset, outcome, setting.choice.options, densities, path);
    }
  }
  return study_of("fit", path ? kOfPrediction : kOfLaws, Packings::chosen,
                  {{"dataset_digest", everything.dataset.digest}, {"coupling", to_string(everything.options.coupling)}},
                  outcomes, 0);
}

}  // namespace grainlaw::chain
