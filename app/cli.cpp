#include "app/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <new>
#include <thread>

#include "app/commands/calibrate.hpp"
#include "app/commands/predict.hpp"
#include "app/commands/simulate.hpp"
#include "app/commands/study_chain.hpp"
#include "app/commands/study_dem.hpp"
#include "app/commands/study_fit.hpp"
#include "app/commands/study_integrator.hpp"
#include "app/exit_code.hpp"
#include "app/terminal/interrupt.hpp"
#include "model/files/one_line.hpp"
#include "app/report/report.hpp"
#include "app/terminal/progress_printer.hpp"
#include "app/terminal/session.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 ok, 1 failure, 2 invalid input or usage, 3 did not converge, 130 interrupted.\n"
    "Results go to standard output, progress and messages to standard error. Files: docs/formats.md";

struct Common {
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool json = false;
  bool quiet = false;
  bool resume = true;
  double checkpoint_interval = 60;
};

/// What the user asked for, set by the callback of the chosen command.
using Task = std::function<ExitCode(Session&)>;

void add_common(CLI::App& command, Common& common) {
  command.add_option("--threads", common.threads, "threads of all runs together; results do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command.add_flag("--json", common.json, "result on standard output as JSON");
  command.add_flag("--quiet", common.quiet, "no progress, no warnings");
  command.footer(kExitCodes);
}

/// The names of an enum as values of an option.
template <NamedEnum E>
CLI::CheckedTransformer by_name() {
  std::map<std::string, E> values;
  for (const E value : kValues<E>) values[to_string(value)] = value;
  return CLI::CheckedTransformer(values);
}

/// Of the commands that run DEM.
void add_checkpoints(CLI::App& command, Common& common) {
  command.add_flag("--resume,!--no-resume", common.resume,
                   "go on from the checkpoints of interrupted runs (default); --no-resume starts them anew");
  command
      .add_option("--checkpoint", common.checkpoint_interval, "seconds between two checkpoints of a run; 0: every step")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
}

void add_simulate(CLI::App& app, Common& common, Task& task) {
  CLI::App* command = app.add_subcommand("simulate", "one packing or one element test in the DEM engine");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("TEST", options->test, "TEST.json")->required();
  command->add_option("-o,--output", options->output, "folder for series, states and summary")->required();
  add_checkpoints(*command, common);
  add_common(*command, common);
  command->callback([options, &task] { task = [options](Session& session) { return simulate(*options, session); }; });
}

void add_calibrate(CLI::App& app, Common& common, Task& task) {
  CLI::App* command =
      app.add_subcommand("calibrate", "packings and element tests of a spec, then the law's parameters");
  auto options = std::make_shared<CalibrateOptions>();
  command->add_option("SPEC", options->spec, "SPEC.json; may be left out with --dataset");
  command->add_option("-o,--output", options->output, "folder of the calibration")->required();
  command->add_option("--dataset", options->dataset, "fit this data set without running DEM");
  CLI::Option* target =
      command
          ->add_option(
              "--target-error", options->target_error,
              "plan the cheapest runs after which the prediction along --for is known to this, e.g. 0.02: half width "
              "of its 95 % band with what rate, step and size do, over the largest value; overrides N, seeds, rate, "
              "step, densities and shear strain of SPEC")
          ->check(CLI::Range(1e-4, 1.0));
  command->add_option("--for", options->target_path, "PATH.json of that prediction")->needs(target);
  command->add_option("--quantity", options->quantities, "what must be known: P_star, s_par, F_par; default: all")
      ->needs(target)
      ->delimiter(',')
      ->check(CLI::IsMember({"P_star", "s_par", "F_par"}));
  command->add_option("--max-cost", options->max_cost, "seconds that the pilot and all runs of the plan may take")
      ->needs(target)
      ->check(CLI::Range(0.0, 1e9));
  command->add_option("--coupling", options->coupling, "coupling of Eq. (16) instead of the spec's")
      ->transform(by_name<Coupling>());
  command
      ->add_option("--loss", options->loss,
                   "squares (default) or huber: rows that are far off, in units of their scatter, count for less")
      ->transform(by_name<fit::Loss>());
  command->add_option("--starts", options->starts, "starts of the coupled fits, of which the lowest minimum is kept")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--checks", options->checks,
                    "fits without each packing in turn, and likelihood profiles of doubtful parameters; takes several "
                    "times as long as the fit");
  add_checkpoints(*command, common);
  add_common(*command, common);
  command->callback([options, &task] { task = [options](Session& session) { return calibrate(*options, session); }; });
}

void add_predict(CLI::App& app, Common& common, Task& task) {
  CLI::App* command = app.add_subcommand("predict", "the calibrated law along a strain path, and DEM of the same path");
  auto options = std::make_shared<PredictOptions>();
  command->add_option("PARAMETERS", options->parameters, "parameters.json of a calibration")->required();
  command->add_option("PATH", options->path, "PATH.json")->required();
  command->add_option("-o,--output", options->output, "folder of the prediction")->required();
  CLI::Option* dem = command->add_flag("--dem", options->dem, "run the path in the engine on new packings and compare");
  command
      ->add_option("--against", options->against,
                   "compare with finished runs of the path: the folder of a data set, or of a prediction with --dem")
      ->excludes(dem);
  command
      ->add_option("--model", options->model,
                   "rung of the law: reduced, evolution or memory; default: those that are calibrated")
      ->transform(by_name<Rung>());
  command
      ->add_option("--initial", options->initial,
                   "start from the law or from measured values; default: law, with --dem both")
      ->transform(by_name<predict::Initial>());
  command->add_option("--seeds", options->seeds, "seeds of the new packings, e.g. 11,12")->delimiter(',');
  command->add_option("--spec", options->spec,
                      "SPEC of the new packings; default: spec.resolved.json beside PARAMETERS");
  command->add_option("--store", options->store, "folder that holds runs/; default: that of PARAMETERS");
  add_checkpoints(*command, common);
  add_common(*command, common);
  command->callback(
      [options, &task] { task = [options](Session& session) { return run_prediction(*options, session); }; });
}

void add_report(CLI::App& app, Common& common, Task& task) {
  CLI::App* command = app.add_subcommand("report", "one HTML page about a calibration and its predictions");
  auto folder = std::make_shared<std::filesystem::path>(), html = std::make_shared<std::filesystem::path>();
  command->add_option("DIR", *folder, "folder of a calibration")->required();
  command->add_option("-o,--output", *html, "file of the page, e.g. report.html")->required();
  add_common(*command, common);
  command->callback([folder, html, &task] {
    task = [folder, html](Session& session) {
      write_report(*folder, *html);
      print_result(session.json ? json_text({{"report", html->string()}})
                                : fmt::format("{}\n{}\n", summary_table(*folder), html->string()));
      return ExitCode::ok;
    };
  });
}

void add_study_dem(CLI::App& study, Common& common, Task& task) {
  CLI::App* command =
      study.add_subcommand("dem", "what settings of the engine cost and how far they are from a reference");
  auto options = std::make_shared<StudyDemOptions>();
  command->add_option("SPEC", options->spec, "SPEC.json, the setting that is judged")->required();
  command->add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")->required();
  command->add_option("--reference", options->reference, "KEY=VALUE of SPEC that make the reference")->required();
  command->add_option("--vary", options->vary, "KEY=VALUE of SPEC, one setting each")->required();
  add_checkpoints(*command, common);
  add_common(*command, common);
  command->callback([options, &task] { task = [options](Session& session) { return study_dem(*options, session); }; });
}

void add_study_chain(CLI::App& study, Common& common, Task& task) {
  CLI::App* command = study.add_subcommand(
      "chain", "what settings from packings to a prediction cost and how far it is from that of a reference");
  auto options = std::make_shared<StudyChainOptions>();
  command->add_option("SPEC", options->spec, "SPEC.json, the setting that is judged")->required();
  command->add_option("--for", options->path, "PATH.json of the prediction")->required();
  command->add_option("-o,--output", options->output, "folder for study.json, settings.svg and runs")->required();
  command->add_option("--reference", options->reference,
                      "KEY=VALUE of SPEC that make the reference; without any SPEC itself is the reference");
  command
      ->add_option("--vary", options->vary,
                   "KEY=VALUE of SPEC, one setting each, e.g. seeds=[1,2] or tests[1].strain=0.2")
      ->required();
  add_checkpoints(*command, common);
  add_common(*command, common);
  command->callback(
      [options, &task] { task = [options](Session& session) { return study_chain(*options, session); }; });
}

void add_study_fit(CLI::App& study, Common& common, Task& task) {
  CLI::App* command = study.add_subcommand("fit", "what a fit loses that leaves out a part of the data; runs no DEM");
  auto options = std::make_shared<StudyFitOptions>();
  command->add_option("FOLDER", options->dataset, "folder of a data set or of a calibration")->required();
  command->add_option("-o,--output", options->output, "folder for study.json and settings.svg")->required();
  command->add_option("--for", options->path, "PATH.json of a prediction to judge by; default: the laws");
  command->add_option(
      "--vary", options->vary,
      "KEY=VALUE, one setting each: rows_every=k, packings=n, densities_every=k, shear_strain=fraction, "
      "loss=huber; default: the usual ones");
  add_common(*command, common);
  command->callback([options, &task] { task = [options](Session& session) { return study_fit(*options, session); }; });
}

void add_study(CLI::App& app, Common& common, Task& task) {
  CLI::App* study = app.add_subcommand("study", "measurements of the program itself: integrator, dem, fit, chain");
  study->require_subcommand(1);
  study->footer(kExitCodes);
  CLI::App* command = study->add_subcommand("integrator", "what integrating a path costs at which error");
  auto options = std::make_shared<StudyIntegratorOptions>();
  command->add_option("-o,--output", options->output, "folder for study.json and work_precision.svg")->required();
  command->add_option("--parameters", options->parameters, "parameters.json; default: the published values");
  command->add_option("--repeats", options->repeats, "repeats of each path, of which the least time counts")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--paths", options->paths, "paths of the batch over all threads")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  add_common(*command, common);
  command->callback(
      [options, &task] { task = [options](Session& session) { return study_integrator(*options, session); }; });
  add_study_dem(*study, common, task);
  add_study_fit(*study, common, task);
  add_study_chain(*study, common, task);
}

int fail(ExitCode code, const std::string& message) {
  std::fputs(fmt::format("grainlaw: {}\n", one_line(message)).c_str(), stderr);  // the exit code says it too
  return static_cast<int>(code);
}

std::string command_line(int argc, char** argv) {
  std::string text = "grainlaw";
  for (int i = 1; i < argc; ++i) text += fmt::format(" {}", one_line(argv[i]));
  return text;
}

int perform(const Task& task, const Common& common, const std::string& command) {
  try {
    const InterruptGuard interrupt;
    ProgressPrinter progress(stderr, common.quiet);
    Session session{{.threads = common.threads,
                     .stop = interrupt.token(),
                     .watch = progress,
                     .resume = common.resume,
                     .checkpoint_interval = common.checkpoint_interval,
                     .command = command},
                    common.json};
    return static_cast<int>(task(session));
  } catch (const InvalidInput& error) {
    return fail(ExitCode::invalid_input, error.what());
  } catch (const NotConverged& error) {
    return fail(ExitCode::not_converged, error.what());
  } catch (const Interrupted& error) {
    return fail(ExitCode::interrupted, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::failure, "out of memory; use fewer particles or threads");
  } catch (const std::exception& error) {
    return fail(ExitCode::failure, error.what());
  }
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App app("grainlaw: from frictionless grains to an incremental constitutive law and back", "grainlaw");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(kExitCodes);
  Common common;
  Task task;
  for (const auto add : {add_simulate, add_calibrate, add_predict, add_report, add_study}) add(app, common, task);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    return fail(ExitCode::invalid_input, fmt::format("{}; see grainlaw --help", error.what()));
  } catch (const std::exception& error) {
    return fail(ExitCode::invalid_input, error.what());
  }
  return perform(task, common, command_line(argc, argv));
}

}  // namespace grainlaw::app
