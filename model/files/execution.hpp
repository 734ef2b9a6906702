#pragma once
// How a call of the library is carried out: threads, progress, interruption, resuming, and what its files say of it.

#include <stop_token>
#include <string>

#include "model/files/provenance.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw {

struct Execution {
  int threads = 1;                  ///< of all runs together; results do not depend on it
  std::stop_token stop = {};        ///< a request ends the call with Interrupted; what was finished is on disk
  Watch& watch = nobody();          ///< told of progress
  bool resume = true;               ///< go on from checkpoints of interrupted runs; false: start them anew
  double checkpoint_interval = 60;  ///< between two checkpoints of a run; 0: every step [s]
  std::string command = "library";  ///< who called, for the provenance of files
  Stopwatch stopwatch = {};         ///< started with the call
};

/// provenance() of this call.
OrderedJson provenance(const Execution& execution);

}  // namespace grainlaw
