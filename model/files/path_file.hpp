#pragma once
// PATH: the strain path of a prediction, with the seeds of the packings that --dem runs it on.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "model/files/json_document.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

struct PathFile {
  Path path;
  std::vector<std::uint64_t> seeds;  ///< empty: not given
  std::optional<int> rows;           ///< rows of each segment
};

/// Reads the file and the strain_csv that it may name (relative to its folder). Throws InvalidInput naming file, key or
/// row, reason and remedy.
PathFile read_path(const std::filesystem::path& file);

}  // namespace grainlaw
