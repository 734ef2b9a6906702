#pragma once
// How long work tells its progress and learns that it should stop. Values and callbacks only.

#include <functional>
#include <stop_token>
#include <string>

namespace grainlaw {

/// One report of a running stage.
struct Progress {
  std::string stage;    ///< what is being done, e.g. "seed 1 D2 0.70"
  double fraction = 0;  ///< done part of the stage [0..1]
  double work = 0;      ///< work done so far, that of earlier stages and sessions included [unit]
  std::string unit;     ///< unit of `work`, e.g. "particle-steps"
};

/// Passed by value into every long computation; the default neither reports nor stops.
struct RunControl {
  std::function<void(const Progress&)> report;  ///< called from the computing thread, a few times a second at most; may be empty
  std::stop_token stop;                         ///< checked at least every 0.1 s; the callee then throws Interrupted
};

}  // namespace grainlaw
