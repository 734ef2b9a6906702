#pragma once
// A data set that somebody else has made, taken into a folder of results so that the folder is complete.

#include <filesystem>

#include "model/files/dataset.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

/// `given` itself, or its dataset/ or dem/ when the folder of a calibration or of a prediction was given. Throws
/// InvalidInput when none of them holds a dataset.json.
std::filesystem::path dataset_folder(const std::filesystem::path& given);

/// Copies the data set in `from`, as it was read, to `to`, unless they are the same; returns what is there.
Dataset adopt(const Dataset& dataset, const std::filesystem::path& from, const std::filesystem::path& to);

/// Throws InvalidInput naming the first test in the data set of `name` that does not follow `path`, or that was fitted.
void require_runs_of(const Path& path, const Dataset& dataset, const std::string& name);

}  // namespace grainlaw
