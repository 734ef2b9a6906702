#include "app/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <new>
#include <thread>

#include "app/commands/commands.hpp"
#include "app/exit_code.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/progress_printer.hpp"
#include "app/terminal/session.hpp"
#include "model/files/one_line.hpp"
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

void add_common(CLI::App& command, Common& common) {
  command.add_option("--threads", common.threads, "threads of all runs together; results do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command.add_flag("--json", common.json, "result on standard output as JSON");
  command.add_flag("--quiet", common.quiet, "no progress, no warnings");
  command.footer(kExitCodes);
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

constexpr std::array kCommands{
    Command{"simulate", "one packing or one element test in the DEM engine", declare_simulate, true},
    Command{"calibrate", "packings and element tests of a spec, then the law's parameters", declare_calibrate, true},
    Command{"predict", "the calibrated law along a strain path, and DEM of the same path", declare_predict, true},
    Command{"report", "one HTML page about a calibration and its predictions", declare_report, false}};

constexpr std::array kStudies{
    Command{"integrator", "what integrating a path costs at which error", declare_study_integrator, false},
    Command{"dem", "what settings of the engine cost and how far they are from a reference", declare_study_dem, true},
    Command{"fit", "what a fit loses that leaves out a part of the data; runs no DEM", declare_study_fit, false},
    Command{"chain", "what settings from packings to a prediction cost and how far it is from that of a reference",
            declare_study_chain, true},
    Command{"bands", "whether bands hold on rehearsals that are left out of them", declare_study_bands, false},
    Command{"prior", "what many packings say of the errors of few; runs no DEM", declare_study_prior, false}};

/// Declares `command` below `app`; when it is the one that is given, `chosen` becomes its task.
void add(CLI::App& app, const Command& command, Common& common, Task& chosen) {
  CLI::App* added = app.add_subcommand(command.name, command.description);
  const Task task = command.declare(*added);
  if (command.simulates) add_checkpoints(*added, common);
  add_common(*added, common);
  added->callback([task, &chosen] { chosen = task; });
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
  for (const Command& command : kCommands) add(app, command, common, task);
  CLI::App* study =
      app.add_subcommand("study", "measurements of the program itself: integrator, dem, fit, chain, bands, prior");
  study->require_subcommand(1);
  study->footer(kExitCodes);
  for (const Command& command : kStudies) add(*study, command, common, task);
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
