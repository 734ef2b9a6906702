#pragma once
// How far the jobs of a calibration are, seen from its folder and the queue.

#include <filesystem>
#include <string>
#include <vector>

#include "app/exit_code.hpp"
#include "app/terminal/session.hpp"
#include "dem/runs/spec_file.hpp"

namespace grainlaw::app {

/// Returns when the jobs are over, with the exit code of the calibration, the last of them. Throws Error naming the logs when that
/// has none, Interrupted on request: the jobs go on then.
ExitCode watch_jobs(const dem::Spec& spec, const std::filesystem::path& folder, const std::vector<std::string>& jobs,
                    const Session& session);

}  // namespace grainlaw::app
