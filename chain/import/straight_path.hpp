#pragma once
// Measured strains and straight paths. A path of ours is exact while strains of others carry the digits of a text or the noise of a
// servo, so rows are moved onto it, by less than a stated tolerance.

#include <vector>

#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::chain {

inline constexpr std::size_t kMaxFoundSegments = 1000;  ///< more corners are noise

/// Straight segments through the strains, within `tolerance` of every row [-]: corners by Ramer, Douglas and Peucker; each segment is
/// a mode of Table 1 along some axes, or shear at constant volume, where its rows allow it, else the tensor itself. Strains must
/// begin at zero. Throws InvalidInput when they never leave it by more than the tolerance, or have more corners than above.
std::vector<PathSegment> found_segments(const std::vector<Observation>& rows, double tolerance);

/// How far rows were moved.
struct Moved {
  double farthest = 0;  ///< [-]
  std::size_t row = 0;  ///< which that was, from 0
};

/// Gives each row its segment, and strain and volume fraction of its place there: the nearest that goes forward from row to row, by
/// least squares over all rows. A row at a corner, to `tolerance`, ends the segment before it: the next one starts from it.
Moved move_onto(const Path& path, double tolerance, std::vector<Observation>& rows);

/// "D2 (compression of z) to eps_dev 0.26, ISO ...", for people.
std::string path_text(const Path& path);

}  // namespace grainlaw::chain
