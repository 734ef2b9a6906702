#pragma once
// Who made a file, with what: version and git revision, compiler and flags, libraries, threads, wall time, memory.

#include <chrono>
#include <string>

#include "model/files/json_document.hpp"

namespace grainlaw {

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

/// {grainlaw, git_revision, compiler, build_type, compile_flags, libraries, command, threads, began, seconds, peak_memory_MB}
OrderedJson provenance(const std::string& command, int threads, const Stopwatch& stopwatch);

/// "grainlaw 0.1.0 (revision)".
std::string version_text();

double peak_memory_megabytes();  ///< largest resident memory of this process so far [MB]

}  // namespace grainlaw
