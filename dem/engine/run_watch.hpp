#pragma once
// A long loop's tie to its RunControl: stops it on request and lets progress through a few times a second. Its clock.

#include <chrono>
#include <string>
#include <utility>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::dem {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

class RunWatch {
 public:
  /// `unit` is what tick()'s `work` counts.
  RunWatch(const RunControl& control, std::string stage, std::string unit)
      : control_(control), progress_{std::move(stage), 0, 0, std::move(unit)} {}

  /// Call once per iteration. Throws Interrupted when a stop was requested.
  void tick(double fraction, double work) {
    if (control_.stop.stop_requested()) throw Interrupted(progress_.stage + ": interrupted on request");
    if (!control_.report) return;
    const auto now = Clock::now();
    if (now < next_report_) return;
    next_report_ = now + std::chrono::milliseconds(200);
    progress_.fraction = fraction;
    progress_.work = work;
    control_.report(progress_);
  }

 private:
  const RunControl& control_;
  Progress progress_;
  Clock::time_point next_report_{};
};

}  // namespace grainlaw::dem
