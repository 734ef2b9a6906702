// grainlaw predict PARAMETERS.json PATH.json -o DIR: the calibrated law along a strain path, and how far it is from runs
// of the same path: with --dem in the engine on new packings, with --against finished ones.

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/forecast_text.hpp"
#include "app/terminal/result_text.hpp"
#include "chain/prediction.hpp"
#include "chain/rehearsals.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

struct PredictOptions {
  fs::path parameters;                      ///< parameters.json of a calibration
  fs::path path;                            ///< PATH.json
  fs::path output;                          ///< folder of the prediction
  std::optional<Rung> model;                ///< none: those that are calibrated
  std::optional<predict::Initial> initial;  ///< none: law, and measured too with `dem` or `against`
  bool dem = false;                         ///< run the path in the engine too
  fs::path against;                         ///< data set with runs of the path; empty: none
  std::vector<std::uint64_t> seeds;         ///< of the new packings
  fs::path spec;                            ///< SPEC of the packings; empty: spec.resolved.json beside `parameters`
  fs::path store;                           ///< folder with the runs; empty: that of `parameters`
  bool rehearse = false;                    ///< keep the runs as a rehearsal of the law
  bool dry_run = false;
};

std::string name_of(const PredictOptions& options) {
  return (options.output.has_filename() ? options.output : options.output.parent_path()).filename().string();
}

/// Adds the runs in `folder` to the law's rehearsals, also to the law of `input`. The path's own does not count for its bands.
void keep_as_rehearsal(const PredictOptions& options, const fs::path& folder, const Session& session,
                       chain::PredictionInput& input) {
  chain::add_rehearsal(options.parameters, folder, name_of(options), session);
  const chain::PredictionInput again = chain::read_prediction_input(options.parameters, options.path);
  input.law = again.law;
  input.parameters = again.parameters;
}

ExitCode run_prediction(const PredictOptions& options, Session& session) {
  if (options.rehearse && !options.dem && options.against.empty())
    throw InvalidInput("predict: --rehearse keeps runs; give --against or --dem too");
  if (!options.dem && !(options.seeds.empty() && options.spec.empty() && options.store.empty()))
    throw InvalidInput("predict: --seeds, --spec and --store are of new runs; give --dem too");
  chain::PredictionInput input = chain::read_prediction_input(options.parameters, options.path);
  if (options.rehearse && !law_decides(input.path.path))
    chain::check_rehearsal(input.law, input.path.path, name_of(options));
  input.model = options.model;
  input.initial = options.initial;
  if (options.dem) {
    input.new_runs = chain::new_runs(input, chain::spec_of_calibration(options.spec, options.parameters), options.seeds,
                                     options.store);
  }
  if (!options.against.empty()) input.finished_runs = chain::finished_runs(input, options.against);
  if (options.dry_run) {
    chain::check_prediction(input);
    return say_forecast(options.path.string(), chain::forecast(input, session), session);
  }
  if (options.rehearse && input.finished_runs) keep_as_rehearsal(options, options.against, session, input);
  predict::PredictionFolder prediction = chain::predict_path(input, options.output, session);
  if (options.rehearse && options.dem) {
    keep_as_rehearsal(options, options.output, session, input);
    input.new_runs.reset();
    input.finished_runs = chain::finished_runs(input, options.output);
    prediction = chain::predict_path(input, options.output, session);
  }
  print_result(session.json ? json_text(summary_of(prediction, options.output)) : text_of(prediction, options.output));
  return ExitCode::ok;
}

}  // namespace

Task declare_predict(CLI::App& command) {
  const auto options = std::make_shared<PredictOptions>();
  add_value(command, "PARAMETERS", options->parameters, "FILE", "parameters.json of a calibration")->required();
  add_value(command, "PATH", options->path, "FILE", "PATH.json")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder of the prediction")->required();
  add_dry_run(command, options->dry_run);
  CLI::Option* dem = command.add_flag("--dem", options->dem, "run the path in the engine on new packings and compare");
  add_value(command, "--against", options->against, "DIR",
            "compare with finished runs of the path: the folder of a data set, or of a prediction with --dem")
      ->excludes(dem);
  add_choice<Rung>(command, "--model", options->model, "rung of the law; default: those that are calibrated");
  add_choice<predict::Initial>(
      command, "--initial", options->initial,
      "start from the law or from measured values; default: law, with --dem or --against both");
  add_seeds(command, "--seeds", options->seeds, "of the new packings, e.g. 201-205 or 1,3,7-9");
  add_value(command, "--spec", options->spec, "FILE",
            "SPEC of the new packings; default: spec.resolved.json beside PARAMETERS");
  add_value(command, "--store", options->store, "DIR", "folder that holds runs/; default: that of PARAMETERS");
  command.add_flag("--rehearse", options->rehearse,
                   "keep the runs of --against or --dem as a rehearsal in PARAMETERS: how far the law is off on them "
                   "widens the bands of other paths");
  return [options](Session& session) { return run_prediction(*options, session); };
}

}  // namespace grainlaw::app
