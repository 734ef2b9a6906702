// grainlaw calibrate SPEC.json -o DIR: packings -> element tests -> data set -> fit -> parameters; with --target-error by
// the cheapest plan for a prediction.

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/forecast_text.hpp"
#include "app/terminal/result_text.hpp"
#include "chain/planning/target_calibration.hpp"
#include "fit/prior_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

struct CalibrateOptions {
  std::filesystem::path spec;           ///< SPEC.json; may be empty with `dataset`
  std::filesystem::path output;         ///< folder of the calibration
  std::filesystem::path dataset;        ///< fit this data set instead of running DEM; may be empty
  std::optional<Coupling> coupling;     ///< instead of the spec's
  std::optional<double> target_error;   ///< wanted error of the prediction along `target_path` [-]
  std::filesystem::path target_path;    ///< PATH.json of that prediction
  std::vector<std::string> quantities;  ///< those that are wanted; none: all that the path has
  double max_cost = 0;                  ///< of everything together; 0: no limit [s]
  fit::Loss loss = fit::Loss::squares;
  int starts = 1;  ///< of the coupled fits
  double iso_from =
      fit::CalibrationOptions{}.iso_nu_min;  ///< lowest volume fraction of ISO unloading that is fitted [-]
  bool checks = false;                       ///< fits without one packing, likelihood profiles
  bool wait = false;                         ///< for runs that others make
  bool dry_run = false;
  std::string prior;  ///< prior.json of the errors, or "none"; empty: the built-in one
};

ExitCode calibrate_to_target(const CalibrateOptions& options, chain::CalibrationInput input,
                             const fit::CalibrationOptions& fit_options, Session& session) {
  if (!options.dataset.empty())
    throw InvalidInput("calibrate: --target-error makes new runs, which --dataset cannot; leave one of them out");
  if (options.target_path.empty())
    throw InvalidInput("calibrate: --target-error is that of a prediction; give its PATH with --for");
  input.spec->coupling = to_string(fit_options.coupling);
  const auto target =
      chain::read_target(*options.target_error, options.target_path, options.quantities, options.max_cost);
  if (options.dry_run) {
    const auto pilot = chain::forecast_of_pilot(target, *input.spec, options.spec.string(), options.output, session);
    return say_forecast(options.spec.string(), pilot, session);
  }
  const chain::TargetCalibration result =
      chain::calibrate_for(target, *input.spec, options.spec.string(), fit_options, options.output, session);
  print_result(session.json ? json_text(result.document) : text_of(result, target, options.output));
  return result.run.outcome == chain::TargetOutcome::met ? ExitCode::ok : ExitCode::not_converged;
}

ExitCode calibrate(const CalibrateOptions& options, Session& session) {
  if (options.wait && (options.target_error || !options.dataset.empty()))
    throw InvalidInput("calibrate: --wait waits for the runs of SPEC; leave --target-error and --dataset out");
  const chain::CalibrationInput input = chain::read_calibration_input(options.spec, options.dataset);
  fit::CalibrationOptions fit_options = chain::fit_options_of(input, session);
  fit_options.loss = options.loss;
  fit_options.starts = options.starts;
  fit_options.iso_nu_min = options.iso_from;
  fit_options.profiles = options.checks;
  fit_options.coupling = options.coupling.value_or(fit_options.coupling);
  if (options.prior == "none")
    fit_options.prior.reset();
  else if (!options.prior.empty())
    fit_options.prior = fit::read_prior(options.prior);
  if (options.target_error) return calibrate_to_target(options, input, fit_options, session);
  if (options.dry_run)
    return say_forecast((options.dataset.empty() ? options.spec : options.dataset).string(),
                        chain::forecast(input, options.output, session), session);
  const auto missing = options.wait ? dem::MissingRuns::awaited : dem::MissingRuns::simulated;
  const chain::CalibrationResult result = chain::calibrate(input, fit_options, options.output, session, missing);
  print_result(session.json ? json_text(summary_of(result, options.output, session))
                            : text_of(result, options.output, session));
  return result.calibration.law.converged ? ExitCode::ok : ExitCode::not_converged;
}

}  // namespace

Task declare_calibrate(CLI::App& command) {
  const auto options = std::make_shared<CalibrateOptions>();
  add_value(command, "SPEC", options->spec, "FILE", "SPEC.json; may be left out with --dataset");
  add_value(command, "-o,--output", options->output, "DIR", "folder of the calibration")->required();
  add_value(command, "--dataset", options->dataset, "DIR", "fit this data set without running DEM");
  add_dry_run(command, options->dry_run);
  command.add_flag("--wait", options->wait,
                   "simulate nothing: wait for runs that others make, and name those that are missing");
  CLI::Option* target = add_number(command, "--target-error", options->target_error, 1e-4, 1, "ERROR",
                                   "plan the cheapest runs after which the prediction along --for is known to this, "
                                   "e.g. 0.02: half width of its 95 % band with what rate, step and size do, over the "
                                   "largest value; overrides N, seeds, rate, step, densities and shear strain of SPEC");
  add_value(command, "--for", options->target_path, "FILE", "PATH.json of that prediction")->needs(target);
  const std::vector<std::string> quantities{"P_star", "s_par", "F_par"};
  add_value(command, "--quantity", options->quantities, choice_type(quantities), "what must be known; default: all")
      ->needs(target)
      ->delimiter(',')
      ->check(CLI::Validator(
          [quantities](const std::string& text) {
            chosen("--quantity", text, quantities);
            return std::string();
          },
          ""));
  add_number(command, "--max-cost", options->max_cost, 0, 1e9, "SECONDS",
             "seconds that the pilot and all runs of the plan may take")
      ->needs(target);
  add_choice<Coupling>(command, "--coupling", options->coupling, "coupling of Eq. (16) instead of the spec's");
  add_choice<fit::Loss>(command, "--loss", options->loss,
                        "squares (default) or huber: rows that are far off, in units of their scatter, count for less");
  add_number(command, "--starts", options->starts, 1, 10000, "N",
             "starts of the coupled fits, of which the lowest minimum is kept")
      ->capture_default_str();
  add_number(command, "--iso-from", options->iso_from, 0.5, 0.8, "NU",
             "lowest volume fraction of isotropic unloading that is fitted: somewhat above jamming, which friction "
             "lowers")
      ->capture_default_str();
  command.add_flag("--checks", options->checks,
                   "fits without each packing in turn, and likelihood profiles of doubtful parameters; takes several "
                   "times as long as the fit");
  add_value(command, "--prior", options->prior, "FILE",
            "prior.json of study prior, by which the errors of few packings are moderated, or none; default: "
            "the built-in one")
      ->excludes(target);
  return [options](Session& session) { return calibrate(*options, session); };
}

}  // namespace grainlaw::app
