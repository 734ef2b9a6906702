#include "app/commands/study_dem.hpp"

#include <fmt/format.h>

#include "model/files/output_folder.hpp"
#include "app/report/figure_study.hpp"
#include "chain/studies/packing_quantities.hpp"
#include "chain/studies/settings_study.hpp"
#include "chain/studies/spec_settings.hpp"
#include "chain/studies/study_json.hpp"
#include "app/commands/study_output.hpp"
#include "app/commands/study_table.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kErrorOfPackings =
    "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the difference "
    "from "
    "the reference, mean over packings, each over its chance: the standard error of that difference";

}  // namespace

ExitCode study_dem(const StudyDemOptions& options, Session& session) {
  const std::vector<chain::SpecSetting> settings = chain::settings_of(options.spec, options.reference, options.vary);
  const chain::SpecSetting& base = settings[1];
  for (const chain::SpecSetting& setting : settings) {
    if (setting.spec.seeds != base.spec.seeds)
      throw InvalidInput(
          fmt::format("{}: seeds are what settings are compared over; leave them as they are", setting.name));
  }
  make_output_folder(options.output);
  const auto show = [&](const chain::SpecSetting& setting) -> chain::SettingOutcome {
    const Dataset dataset = chain::run_setting(setting, options.output, session);
    const std::vector<std::uint64_t> seeds = chain::packings_of(dataset);
    return {setting.name,
            setting.changes,
            chain::cost_of(dataset),
            seeds,
            chain::packing_quantities(dataset, seeds),
            {},
            chain::energy_residual_of(dataset),
            "",
            ""};
  };
  const chain::SettingsStudy study = chain::study_of("dem", kErrorOfPackings, chain::Packings::given, Json(dem::spec_to_json(base.spec)),
                                       chain::outcomes_of(settings, 1, session, show), 1);
  finish_study(options.output, chain::study_to_json(study), "settings.svg", report::figure_of(study), study_table(study),
               session);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
