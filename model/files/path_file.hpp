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
  std::vector<std::string> warnings = {};
};

/// Reads the file and the measured strain history that it may name instead of segments, strain_csv (relative to its
/// folder). Of that are read the columns strain_xx, strain_yy, strain_zz and, where there are any, strain_yz,
/// strain_xz, strain_xy (logarithmic, tension positive, counted from the first row); other columns are not read, so
/// that any series or prediction will do. Rows within 2e-5 of a straight line, in its order, become one segment, repeated ones
/// none; a warning tells of rows that look like noise.
/// Throws InvalidInput naming file, key or row, reason and remedy: also fewer than two different rows, a strain that is
/// missing or absurd, a volume fraction beyond 0.9, more than 10000 segments.
PathFile read_path(const std::filesystem::path& file);

/// The same of a document that has been read, `name` in messages; strain_csv is relative to `folder`.
PathFile path_from_document(const Json& document, const std::filesystem::path& folder, const std::string& name);

}  // namespace grainlaw
