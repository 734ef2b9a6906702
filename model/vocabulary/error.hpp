#pragma once
// One exception type per exit code: whoever catches at the door needs to know only the kind.

#include <stdexcept>
#include <string>

namespace grainlaw {

/// A computation failed (exit code 1). The message names the object and the remedy in one line.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What the user gave is not valid (exit code 2): file, key or row, reason, remedy in one line.
struct InvalidInput : Error {
  using Error::Error;
};

/// An iteration ended without meeting its criterion (exit code 3).
struct NotConverged : Error {
  using Error::Error;
};

/// The user asked to stop (exit code 130); what was finished is on disk.
struct Interrupted : Error {
  using Error::Error;
};

}  // namespace grainlaw
