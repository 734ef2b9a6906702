#pragma once
// A measured strain history as a path: from each row to the next a straight segment.

#include <filesystem>
#include <vector>

#include "model/vocabulary/path.hpp"

namespace grainlaw {

/// Reads the columns strain_xx, strain_yy, strain_zz and, where there are any, strain_yz, strain_xz, strain_xy
/// (logarithmic, tension positive, counted from the first row); other columns are not read, so that any series or
/// prediction will do. Rows that go on in one direction become one segment, repeated rows none. `nu` is the volume
/// fraction at the first row. Throws InvalidInput naming file, row and column: fewer than two different rows, a strain
/// that is missing or absurd, a volume fraction beyond 0.9, more than 10000 segments.
std::vector<PathSegment> segments_from_csv(const std::filesystem::path& file, double nu);

}  // namespace grainlaw
