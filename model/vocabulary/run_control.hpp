#pragma once
// How long work tells its progress and learns that it should stop. Values and callbacks only.

#include <functional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

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
  std::function<void(const Progress&)>
      report;            ///< called from the computing thread, a few times a second at most; may be empty
  std::stop_token stop;  ///< checked at least every 0.1 s; the callee then throws Interrupted
};

/// Who looks on at a list of jobs. This one sees nothing.
class Watch {
 public:
  virtual ~Watch() = default;

  /// A new list starts: `work` is what each job is expected to do in `unit`, 0 for jobs that are done already. Without a
  /// unit only the fraction that a job reports counts.
  virtual void begin(const std::vector<double>& work, std::string unit) {
    static_cast<void>(work), static_cast<void>(unit);
  }

  /// What the job with this index in the list reports to, and learns of `stop` from.
  virtual RunControl control(std::size_t job, std::string name, std::stop_token stop) {
    static_cast<void>(job), static_cast<void>(name);
    return {{}, std::move(stop)};
  }
  virtual void finished(std::size_t job) { static_cast<void>(job); }

  /// The list has ended, or was given up.
  virtual void end() {}

  /// A message of one line.
  virtual void log(const std::string& text) { static_cast<void>(text); }
};

/// For calls that nobody looks on at.
inline Watch& nobody() {
  static Watch watch;
  return watch;
}

}  // namespace grainlaw
