#pragma once
// The runs of a calibration and how far they are, as text and JSON.

#include <filesystem>
#include <string>
#include <vector>

#include "dem/runs/task_list.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::app {

struct RunListing {
  std::vector<dem::ListedRun> finished, missing;  ///< `missing`: made now by somebody, too
  std::vector<std::string> made;                  ///< keys of those that somebody makes now
};

/// As the store of a calibration's folder has them, which need not exist.
RunListing listing_of(const std::vector<dem::ListedRun>& runs, const std::filesystem::path& output);

/// Counts, a line for each missing run, and what to do with the tasks where there are some.
std::string text_of(const RunListing& listing, const std::filesystem::path& output);

/// {runs, runs_found, runs_being_made, tasks, particle_steps (of the missing), list: [ListedRun with its state]}
OrderedJson to_json(const RunListing& listing);

}  // namespace grainlaw::app
