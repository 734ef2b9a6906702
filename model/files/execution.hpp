#pragma once
// How a call of the library is carried out: threads, progress, interruption, resuming; and what its files say of that
// and of who made them: version and git revision, compiler and flags, libraries, threads, wall time, memory.

#include <chrono>
#include <stop_token>
#include <string>

#include "model/files/json_document.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw {

/// Version of the engine's results. Finished runs are found again by the digest of their spec and this number, so raise
/// it with every change that moves any bit of a series or of a state.
inline constexpr int kEngineVersion = 4;

/// Started with a command, asked when its files are written.
class Stopwatch {
 public:
  double seconds() const;                              ///< wall time since construction [s]
  const std::string& began() const { return began_; }  ///< UTC, ISO 8601
  Stopwatch();

 private:
  std::chrono::steady_clock::time_point start_;
  std::string began_;
};

struct Execution {
  int threads = 1;                  ///< of all runs together; results do not depend on it
  std::stop_token stop = {};        ///< a request ends the call with Interrupted; what was finished is on disk
  Watch& watch = nobody();          ///< told of progress
  bool resume = true;               ///< go on from checkpoints of interrupted runs; false: start them anew
  double checkpoint_interval = 60;  ///< between two checkpoints of a run; 0: every step [s]
  std::string command = "library";  ///< who called, for the provenance of files
  Stopwatch stopwatch = {};         ///< started with the call
  std::string lammps = {};          ///< executable of LAMMPS, for runs that ask for it; empty: lmp on PATH
  std::string launcher = {};        ///< words before it, parted by blanks, e.g. "mpirun -n 2"; empty: none
};

/// {grainlaw, git_revision, compiler, build_type, compile_flags, libraries, command, threads, began, seconds,
/// peak_memory_MB}
OrderedJson provenance(const std::string& command, int threads, const Stopwatch& stopwatch);
OrderedJson provenance(const Execution& execution);

/// "grainlaw 0.1.0 (revision)".
std::string version_text();

double peak_memory_megabytes();  ///< largest resident memory of this process so far [MB]

}  // namespace grainlaw
