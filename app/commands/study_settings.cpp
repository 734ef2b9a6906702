// grainlaw study dem | fit | chain: what settings of the program cost, and how far they are from a reference.

#include "app/commands/commands.hpp"
#include "app/commands/finish_study.hpp"
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
  command.add_option("SPEC", options->data, "SPEC.json, the setting that is judged")->required()->type_name("FILE");
  command.add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")
      ->required()
      ->type_name("DIR");
  command.add_option("--reference", options->reference, "KEY=VALUE of SPEC that make the reference")
      ->required()
      ->type_name("KEY=VALUE");
  command.add_option("--vary", options->vary, "KEY=VALUE of SPEC, one setting each")
      ->required()
      ->type_name("KEY=VALUE");
  return [options](Session& session) { return study_dem(*options, session); };
}

Task declare_study_chain(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  command.add_option("SPEC", options->data, "SPEC.json, the setting that is judged")->required()->type_name("FILE");
  command.add_option("--for", options->path, "PATH.json of the prediction")->required()->type_name("FILE");
  command.add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")
      ->required()
      ->type_name("DIR");
  command
      .add_option("--reference", options->reference,
                  "KEY=VALUE of SPEC that make the reference; without any SPEC itself is the reference")
      ->type_name("KEY=VALUE");
  command
      .add_option("--vary", options->vary,
                  "KEY=VALUE of SPEC, one setting each, e.g. seeds=[1,2] or tests[1].strain=0.2")
      ->required()
      ->type_name("KEY=VALUE");
  return [options](Session& session) { return study_chain(*options, session); };
}

Task declare_study_fit(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  command.add_option("FOLDER", options->data, "folder of a data set or of a calibration")->required()->type_name("DIR");
  command.add_option("-o,--output", options->output, "folder for study.json and settings.svg")
      ->required()
      ->type_name("DIR");
  command.add_option("--for", options->path, "PATH.json of a prediction to judge by; default: the laws")
      ->type_name("FILE");
  command
      .add_option("--vary", options->vary,
                  "KEY=VALUE, one setting each: rows_every=k, packings=n, densities_every=k, shear_strain=fraction, "
                  "loss=huber; default: the usual ones")
      ->type_name("KEY=VALUE");
  return [options](Session& session) { return study_fit(*options, session); };
}

}  // namespace grainlaw::app
