#include "app/commands/study_dem.hpp"

#include <fmt/format.h>

#include "app/output_folder.hpp"
#include "app/study/figure_study.hpp"
#include "app/study/packing_quantities.hpp"
#include "app/study/settings_study.hpp"
#include "app/study/spec_settings.hpp"
#include "app/study/study_json.hpp"
#include "app/study/study_output.hpp"
#include "app/study/study_table.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kErrorOfPackings =
    "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the difference "
    "from "
    "the reference, mean over packings, each over its chance: the standard error of that difference";

}  // namespace

ExitCode study_dem(const StudyDemOptions& options, Session& session) {
  const std::vector<SpecSetting> settings = settings_of(options.spec, options.reference, options.vary);
  const SpecSetting& base = settings[1];
  for (const SpecSetting& setting : settings) {
    if (setting.spec.seeds != base.spec.seeds)
      throw InvalidInput(
          fmt::format("{}: seeds are what settings are compared over; leave them as they are", setting.name));
  }
  make_output_folder(options.output);
  const auto show = [&](const SpecSetting& setting) -> SettingOutcome {
    const Dataset dataset = run_setting(setting, options.output, session);
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
  const SettingsStudy study = study_of("dem", kErrorOfPackings, Packings::given, Json(spec_to_json(base.spec)),
                                       outcomes_of(settings, 1, session, show), 1);
  finish_study(options.output, study_to_json(study), "settings.svg", report::figure_of(study), study_table(study),
               session);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
