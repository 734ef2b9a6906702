#include "app/cli.hpp"

#include <cxxabi.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <typeinfo>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/exit_code.hpp"
#include "app/terminal/help.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/progress_printer.hpp"
#include "app/terminal/session.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 ok, 1 failure, 2 invalid input or usage, 3 did not converge,\n"
    "130 interrupted. Results go to standard output, progress and messages to\n"
    "standard error.";

struct Common {
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool json = false;
  bool quiet = false;
  bool resume = true;
  double checkpoint_interval = 60;
  std::string lammps, launcher;
};

void add_common(CLI::App& command, Common& common) {
  command.add_flag("--json", common.json, "result on standard output as JSON");
  command.add_flag("--quiet", common.quiet, "no progress, no warnings");
}

void add_threads(CLI::App& command, Common& common) {
  add_number(command, "--threads", common.threads, 1, 1024, "N",
             "threads of all runs together; results do not depend on it")
      ->default_str("all cores");
}

/// Of the commands that run DEM.
void add_lammps(CLI::App& command, Common& common) {
  add_value(command, "--lammps", common.lammps, "FILE",
            "executable of LAMMPS, for \"engine\": \"lammps\"; default: lmp on PATH");
  add_value(command, "--launcher", common.launcher, "WORDS",
            "words before it, parted by blanks, as \"mpirun -n 2\"; each run of --threads N starts them");
}
void add_checkpoints(CLI::App& command, Common& common) {
  command.add_flag(
      "--resume,!--no-resume", common.resume,
      "go on from the checkpoints of interrupted runs, as is done without it; --no-resume starts them anew");
  add_number(command, "--checkpoint", common.checkpoint_interval, 0, 1e6, "SECONDS",
             "seconds between two checkpoints of a run; 0: every step")
      ->capture_default_str();
}

using Kind = Command::Kind;

constexpr std::array kCommands{
    Command{"init", "a commented starter: SPEC, TEST, PATH or a data set", declare_init, Kind::says},
    Command{"check", "whether files are sound, what they would run, how long, how much disk", declare_check,
            Kind::computes},
    Command{"simulate", "one packing or one element test in the DEM engine", declare_simulate, Kind::simulates},
    Command{"import", "series and particles of others as a data set", declare_import, Kind::computes},
    Command{"calibrate", "packings and element tests of a spec, then the law's parameters", declare_calibrate,
            Kind::simulates},
    Command{"runs", "which runs a calibration needs and which are missing; deals them out to tasks", declare_runs,
            Kind::watches},
    Command{"task", "the runs of one task, or single runs, on any machine", declare_task, Kind::simulates},
    Command{"submit", "the tasks and the calibration as jobs of Slurm", declare_submit, Kind::watches},
    Command{"predict", "the calibrated law along a strain path, and DEM of the same path", declare_predict,
            Kind::simulates},
    Command{"export", "states, runs and data sets as files of other programs", declare_export, Kind::computes},
    Command{"report", "one HTML page about a calibration and its predictions", declare_report, Kind::computes}};

constexpr std::array kStudies{
    Command{"integrator", "what integrating a path costs at which error", declare_study_integrator, Kind::computes},
    Command{"dem", "what settings of the engine cost and how far they are from a reference", declare_study_dem,
            Kind::simulates},
    Command{"fit", "what a fit loses that leaves out a part of the data; runs no DEM", declare_study_fit,
            Kind::computes},
    Command{"chain", "what settings from packings to a prediction cost and how far it is from that of a reference",
            declare_study_chain, Kind::simulates},
    Command{"bands", "whether bands hold on rehearsals that are left out of them", declare_study_bands, Kind::computes},
    Command{"prior", "what many packings say of the errors of few; runs no DEM", declare_study_prior, Kind::computes}};

constexpr std::array kAboutItself{
    Command{"completion", "script of a shell that completes commands and options", declare_completion, Kind::says},
    Command{"man", "manual pages of all commands, into a folder", declare_man, Kind::says}};

/// Declares `command` below `app`; when it is the one that is given, `chosen` becomes its task.
void add(CLI::App& app, const Command& command, Common& common, Task& chosen) {
  CLI::App* added = app.add_subcommand(command.name, command.description);
  const Task task = command.declare(*added);
  for (CLI::Option* option : added->get_options()) option->check(not_empty());
  if (command.kind == Kind::simulates) {
    add_checkpoints(*added, common);
    add_lammps(*added, common);
  }
  if (command.kind >= Kind::computes) add_threads(*added, common);
  if (command.kind != Kind::says) add_common(*added, common);
  added->callback([task, &chosen] { chosen = task; });
}

/// The whole command line.
void declare(CLI::App& app, Common& common, Task& chosen) {
  app.set_version_flag("--version", version_text(), "version and git revision");
  app.set_help_flag("-h,--help", "this text");
  app.require_subcommand(1);
  app.footer(kExitCodes);
  use_own_help(app);
  for (const Command& command : kCommands) add(app, command, common, chosen);
  CLI::App* study = app.add_subcommand("study", "measurements of the program itself");
  study->require_subcommand(1);
  for (const Command& command : kStudies) add(*study, command, common, chosen);
  for (const Command& command : kAboutItself) add(app, command, common, chosen);
  app.add_subcommand("help", "the same as COMMAND --help")->add_option("COMMAND", "of which command")->expected(-1);
  for (CLI::App* command : app.get_subcommands({})) command->set_version_flag("--version", version_text())->group("");
  for (CLI::App* command : study->get_subcommands({}))
    command->set_version_flag("--version", version_text())->group("");
}

int fail(ExitCode code, const std::string& message) {
  std::fputs(fmt::format("grainlaw: {}\n", one_line(message)).c_str(), stderr);  // the exit code says it too
  return static_cast<int>(code);
}

/// Without needing any.
int fail_without_memory() {
  std::fputs("grainlaw: out of memory; use fewer particles or threads\n", stderr);
  return static_cast<int>(ExitCode::failure);
}

std::atomic<bool> ran_out{false};

[[noreturn]] void throw_without_memory() {
  ran_out = true;
  throw std::bad_alloc();
}

/// Where an exception cannot go on. Memory may run out where none may be thrown, as in the destructor of nlohmann's Json and in
/// std::filesystem: the same message and exit code then; temporary files and locks that stay are removed by who comes next.
[[noreturn]] void end_at_once() {
  const std::type_info* const thrown = abi::__cxa_current_exception_type();
  if (thrown ? *thrown == typeid(std::bad_alloc) : ran_out.load()) _exit(fail_without_memory());
  __gnu_cxx::__verbose_terminate_handler();
  std::abort();
}

/// Of the system: of a thread that it does not start the reason alone says little.
std::string text_of(const std::system_error& error) {
  if (error.code() != std::errc::resource_unavailable_try_again) return error.what();
  return fmt::format("threads: the system starts no more ({}); give fewer with --threads", error.what());
}

std::string command_line(int argc, char** argv) {
  std::string text = "grainlaw";
  for (int i = 1; i < argc; ++i) text += fmt::format(" {}", one_line(argv[i]));
  return text;
}

int perform(const Task& task, const Common& common, const std::string& command) {
  std::stop_token stop;
  try {
    const InterruptGuard interrupt;
    stop = interrupt.token();
    ProgressPrinter progress(stderr, common.quiet);
    Session session{{.threads = common.threads,
                     .stop = stop,
                     .watch = progress,
                     .resume = common.resume,
                     .checkpoint_interval = common.checkpoint_interval,
                     .command = command,
                     .lammps = common.lammps,
                     .launcher = common.launcher},
                    common.json};
    return static_cast<int>(task(session));
  } catch (const InvalidInput& error) {
    if (stop.stop_requested()) return fail(ExitCode::interrupted, fmt::format("interrupted: {}", error.what()));
    return fail(ExitCode::invalid_input, error.what());
  } catch (const NotConverged& error) {
    return fail(ExitCode::not_converged, error.what());
  } catch (const Interrupted& error) {
    return fail(ExitCode::interrupted, error.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::system_error& error) {
    return fail(ExitCode::failure, text_of(error));
  } catch (const std::exception& error) {
    if (stop.stop_requested()) return fail(ExitCode::interrupted, fmt::format("interrupted: {}", error.what()));
    return fail(ExitCode::failure, error.what());
  }
}

int run_command(int argc, char** argv) {
  CLI::App app("grainlaw: from frictionless grains to an incremental constitutive law and back", "grainlaw");
  Common common;
  Task task;
  declare(app, common, task);
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const bool help = !words.empty() && words.front() == "help";
  if (help) words.erase(words.begin());
  if (const std::string slip = slip_in(app, words); !slip.empty()) return fail(ExitCode::invalid_input, slip);
  const CLI::App& command = command_of(app, words);
  const auto say = [&](const std::string& text) {  // with an error where the output takes nothing
    const Task task_of_saying = [&](Session&) {
      print_result(text);
      return ExitCode::ok;
    };
    return perform(task_of_saying, common, "grainlaw help");
  };
  if (help) return say(command.help());
  if (words.empty() || (words.size() == 1 && !commands_of(command).empty() && &command != &app)) {
    std::fputs((words.empty() ? overview(app) : command.help()).c_str(), stderr);
    return static_cast<int>(ExitCode::invalid_input);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    std::ostringstream text;
    text.exceptions(std::ios::badbit);
    app.exit(wish, text, text);
    return say(text.str());
  } catch (const CLI::ParseError& error) {
    return fail(ExitCode::invalid_input, fmt::format("{}; see {} --help", error.what(), full_name(command)));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return fail(ExitCode::invalid_input, error.what());
  }
  return perform(task, common, command_line(argc, argv));
}

}  // namespace

int run(int argc, char** argv) {
  std::set_new_handler(throw_without_memory);
  std::set_terminate(end_at_once);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the shell's limit is an error of its write then, with a message
  try {
    return run_command(argc, argv);
  } catch (const std::bad_alloc&) {
    return fail_without_memory();
  } catch (const std::exception& error) {
    return fail(ExitCode::failure, error.what());
  }
}

}  // namespace grainlaw::app
