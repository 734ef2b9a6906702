#pragma once
// What every command gets besides its own options.

#include <stop_token>
#include <string>

#include "app/progress_printer.hpp"
#include "app/provenance.hpp"
#include "app/runs/checkpoint_files.hpp"

namespace grainlaw::app {

struct Session {
  std::string command;              ///< command line as typed, for the provenance
  int threads = 1;                  ///< threads of all runs together
  bool json = false;                ///< result on stdout as JSON
  std::stop_token stop;             ///< the user wishes to end
  ProgressPrinter& progress;        ///< stderr
  Stopwatch stopwatch;              ///< started with the command
  bool resume = true;               ///< go on from checkpoints of interrupted runs
  double checkpoint_interval = 60;  ///< [s]

  /// For the run with this name.
  ResumePolicy policy(const std::string& run) const {
    return {resume, checkpoint_interval, [this, run](const std::string& text) { progress.log(run + ": " + text); }};
  }
};

/// Result of a command on stdout. Throws Error when it cannot be written.
void print_result(const std::string& text);

}  // namespace grainlaw::app
