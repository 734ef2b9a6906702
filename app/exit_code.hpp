#pragma once
// Exit codes of every command (docs/formats.md).

namespace grainlaw::app {

enum class ExitCode : int {
  ok = 0,
  failure = 1,        ///< a computation or a file operation failed
  invalid_input = 2,  ///< usage, or a file of the user that is refused
  not_converged = 3,  ///< a fit or an integration ended without meeting its criterion
  interrupted = 130,  ///< SIGINT or SIGTERM; what was finished is on disk
};

}  // namespace grainlaw::app
