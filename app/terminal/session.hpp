#pragma once
// What every command gets besides its own options.

#include <string>

#include "model/files/execution.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {

struct Session : Execution {
  bool json = false;  ///< result on stdout as JSON
};

/// Result of a command on stdout. Throws Error when it cannot be written.
inline void print_result(const std::string& text) { write_as_named("-", text); }

}  // namespace grainlaw::app
