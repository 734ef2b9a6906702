#pragma once
// SIGINT and SIGTERM: the first asks the work to stop at its next safe point, another after half a second or more ends
// the process at once.

#include <memory>
#include <stop_token>

namespace grainlaw::app {

/// Installs the handlers; at most one at a time. The destructor restores the earlier ones, unless there was a signal.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  std::stop_token token() const;  ///< stop is requested by the first signal

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace grainlaw::app
