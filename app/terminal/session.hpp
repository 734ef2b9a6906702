#pragma once
// What every command gets besides its own options.

#include <string>

#include "model/files/execution.hpp"

namespace grainlaw::app {

struct Session : Execution {
  bool json = false;  ///< result on stdout as JSON
};

/// Result of a command on stdout. Throws Error when it cannot be written.
void print_result(const std::string& text);

}  // namespace grainlaw::app
