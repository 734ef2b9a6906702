// grainlaw study dem | fit | chain: what settings of the program cost, and how far they are from a reference.

#include "app/commands/commands.hpp"
#include "app/commands/finish_study.hpp"
#include "app/commands/options.hpp"
#include "chain/studies/calibrated_setting.hpp"
#include "chain/studies/studies.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

struct SettingsOptions {
  fs::path data;                       ///< SPEC.json, or of a study of fits the folder of a data set
  fs::path path;                       ///< PATH.json of the prediction that is judged by; empty: none
  fs::path output;                     ///< folder for study.json, settings.svg, data sets and runs
  std::vector<std::string> reference;  ///< KEY=VALUE, all together
  std::vector<std::string> vary;       ///< KEY=VALUE, one setting each
};

ExitCode study_dem(const SettingsOptions& options, Session& session) {
  const auto settings = chain::settings_of(options.data, options.reference, options.vary);
  return finish_study(chain::study_engine(settings, options.output, session), options.output, "settings.svg", session);
}

ExitCode study_chain(const SettingsOptions& options, Session& session) {
  const auto settings = chain::settings_of(options.data, options.reference, options.vary);
  const Path path = chain::study_path(options.path);
  const std::size_t judged = options.reference.empty() ? 0 : 1;
  return finish_study(chain::study_chain(settings, judged, path, options.output, session), options.output,
                      "settings.svg", session);
}

ExitCode study_fit(const SettingsOptions& options, Session& session) {
  const auto path = options.path.empty() ? std::nullopt : std::optional(chain::study_path(options.path));
  return finish_study(chain::study_fit(options.data, path, options.vary, options.output, session), options.output,
                      "settings.svg", session);
}

}  // namespace

Task declare_study_dem(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  add_value(command, "SPEC", options->data, "FILE", "SPEC.json, the setting that is judged")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder for study.json, settings.svg and runs")->required();
  add_value(command, "--reference", options->reference, "KEY=VALUE", "KEY=VALUE of SPEC that make the reference")
      ->required();
  add_value(command, "--vary", options->vary, "KEY=VALUE", "KEY=VALUE of SPEC, one setting each")->required();
  return [options](Session& session) { return study_dem(*options, session); };
}

Task declare_study_chain(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  add_value(command, "SPEC", options->data, "FILE", "SPEC.json, the setting that is judged")->required();
  add_value(command, "--for", options->path, "FILE", "PATH.json of the prediction")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder for study.json, settings.svg and runs")->required();
  add_value(command, "--reference", options->reference, "KEY=VALUE",
            "KEY=VALUE of SPEC that make the reference; without any SPEC itself is the reference");
  add_value(command, "--vary", options->vary, "KEY=VALUE",
            "KEY=VALUE of SPEC, one setting each, e.g. seeds=[1,2] or tests[1].strain=0.2")
      ->required();
  return [options](Session& session) { return study_chain(*options, session); };
}

Task declare_study_fit(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  add_value(command, "FOLDER", options->data, "DIR", "folder of a data set or of a calibration")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder for study.json and settings.svg")->required();
  add_value(command, "--for", options->path, "FILE", "PATH.json of a prediction to judge by; default: the laws");
  add_value(command, "--vary", options->vary, "KEY=VALUE",
            "KEY=VALUE, one setting each: rows_every=k, packings=n, densities_every=k, shear_strain=fraction, "
            "loss=huber; default: the usual ones");
  return [options](Session& session) { return study_fit(*options, session); };
}

}  // namespace grainlaw::app
