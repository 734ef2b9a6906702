// grainlaw study integrator -o DIR: what integrating a path costs at which error.

#include "app/commands/commands.hpp"
#include "app/commands/finish_study.hpp"
#include "app/commands/options.hpp"
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
  return finish_study(study, options.output, "work_precision.svg", session);
}

}  // namespace

Task declare_study_integrator(CLI::App& command) {
  const auto options = std::make_shared<IntegratorOptions>();
  add_value(command, "-o,--output", options->output, "DIR", "folder for study.json and work_precision.svg")->required();
  command.add_option("--parameters", options->parameters, "parameters.json; default: the published values");
  add_number(command, "--repeats", options->repeats, 1, 1000000, "N",
             "repeats of each path, of which the least time counts")
      ->capture_default_str();
  add_number(command, "--paths", options->paths, 1, 10000000, "N", "paths of the batch over all threads")
      ->capture_default_str();
  return [options](Session& session) { return study_integrator(*options, session); };
}

}  // namespace grainlaw::app
