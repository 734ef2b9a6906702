// grainlaw study integrator | dem | fit | chain: measurements of the program itself.

#include "app/commands/commands.hpp"
#include "app/report/figure_study.hpp"
#include "app/report/svg_figure.hpp"
#include "app/terminal/study_text.hpp"
#include "chain/studies/calibrated_setting.hpp"
#include "chain/studies/studies.hpp"
#include "chain/studies/study_json.hpp"
#include "model/files/output.hpp"
#include "model/parameters_file.hpp"
#include "predict/studies/integrator_study.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

struct IntegratorOptions {
  fs::path output;      ///< folder for study.json and work_precision.svg
  fs::path parameters;  ///< parameters.json; empty: the published values
  int repeats = 50;     ///< of each path; the least time counts
  int paths = 100000;   ///< of the batch
};

struct SettingsOptions {
  fs::path data;                       ///< SPEC.json, or of a study of fits the folder of a data set
  fs::path path;                       ///< PATH.json of the prediction that is judged by; empty: none
  fs::path output;                     ///< folder for study.json, settings.svg, data sets and runs
  std::vector<std::string> reference;  ///< KEY=VALUE, all together
  std::vector<std::string> vary;       ///< KEY=VALUE, one setting each
};

/// How every study ends: study.json and its figure in the folder, the result on standard output.
template <class Study>
ExitCode finish(const Study& study, const fs::path& output, const char* figure, const Session& session) {
  OrderedJson document = study_to_json(study);
  document["provenance"] = provenance(session);
  write_json(output / "study.json", document);
  report::write_svg(output / figure, report::figure_of(study));
  print_result(session.json ? json_text(document) : study_text(study) + (output / "study.json").string() + "\n");
  return ExitCode::ok;
}

predict::IntegratorStudy study_of(const IntegratorOptions& options, int threads) {
  predict::IntegratorStudy study = predict::published_law_study();
  if (!options.parameters.empty()) {
    const CalibratedLaw law = read_parameters(options.parameters).law;
    require_parameters(law, Rung::evolution, options.parameters.string());
    study = {law.parameters, law.coupling, options.parameters.string()};
  }
  study.repeats = options.repeats;
  study.paths = options.paths;
  study.threads = threads;
  return study;
}

ExitCode study_integrator(const IntegratorOptions& options, Session& session) {
  predict::IntegratorStudy study = study_of(options, session.threads);
  make_output_folder(options.output);
  measure(study, session);
  return finish(study, options.output, "work_precision.svg", session);
}

ExitCode study_dem(const SettingsOptions& options, Session& session) {
  const auto settings = chain::settings_of(options.data, options.reference, options.vary);
  return finish(chain::study_engine(settings, options.output, session), options.output, "settings.svg", session);
}

ExitCode study_chain(const SettingsOptions& options, Session& session) {
  const auto settings = chain::settings_of(options.data, options.reference, options.vary);
  const Path path = chain::study_path(options.path);
  const std::size_t judged = options.reference.empty() ? 0 : 1;
  return finish(chain::study_chain(settings, judged, path, options.output, session), options.output, "settings.svg",
                session);
}

ExitCode study_fit(const SettingsOptions& options, Session& session) {
  const auto path = options.path.empty() ? std::nullopt : std::optional(chain::study_path(options.path));
  return finish(chain::study_fit(options.data, path, options.vary, options.output, session), options.output,
                "settings.svg", session);
}

}  // namespace

Task declare_study_integrator(CLI::App& command) {
  const auto options = std::make_shared<IntegratorOptions>();
  command.add_option("-o,--output", options->output, "folder for study.json and work_precision.svg")->required();
  command.add_option("--parameters", options->parameters, "parameters.json; default: the published values");
  command.add_option("--repeats", options->repeats, "repeats of each path, of which the least time counts")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command.add_option("--paths", options->paths, "paths of the batch over all threads")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  return [options](Session& session) { return study_integrator(*options, session); };
}

Task declare_study_dem(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  command.add_option("SPEC", options->data, "SPEC.json, the setting that is judged")->required();
  command.add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")->required();
  command.add_option("--reference", options->reference, "KEY=VALUE of SPEC that make the reference")->required();
  command.add_option("--vary", options->vary, "KEY=VALUE of SPEC, one setting each")->required();
  return [options](Session& session) { return study_dem(*options, session); };
}

Task declare_study_chain(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  command.add_option("SPEC", options->data, "SPEC.json, the setting that is judged")->required();
  command.add_option("--for", options->path, "PATH.json of the prediction")->required();
  command.add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")->required();
  command.add_option("--reference", options->reference,
                     "KEY=VALUE of SPEC that make the reference; without any SPEC itself is the reference");
  command
      .add_option("--vary", options->vary,
                  "KEY=VALUE of SPEC, one setting each, e.g. seeds=[1,2] or tests[1].strain=0.2")
      ->required();
  return [options](Session& session) { return study_chain(*options, session); };
}

Task declare_study_fit(CLI::App& command) {
  const auto options = std::make_shared<SettingsOptions>();
  command.add_option("FOLDER", options->data, "folder of a data set or of a calibration")->required();
  command.add_option("-o,--output", options->output, "folder for study.json and settings.svg")->required();
  command.add_option("--for", options->path, "PATH.json of a prediction to judge by; default: the laws");
  command.add_option(
      "--vary", options->vary,
      "KEY=VALUE, one setting each: rows_every=k, packings=n, densities_every=k, shear_strain=fraction, "
      "loss=huber; default: the usual ones");
  return [options](Session& session) { return study_fit(*options, session); };
}

}  // namespace grainlaw::app
