#pragma once
// After 0.1 of the first shear, stress and fabric point along it (docs/theory/data.md, Direction).

#include <optional>
#include <string>
#include <vector>

#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

inline constexpr double kLeastPressure = 1e-4;  ///< P* below which ratios to it say little, and viscous forces may pull
inline constexpr double kSurelyJammed = 1e-3;   ///< P* from which so many contacts carry that a mean field holds

/// sigma'/P of a row, compression positive; zero where P* is below kLeastPressure.
Deviator<double> stress_ratio(const Observation& o);

struct Misdirection {
  std::size_t row;     ///< last one that was looked at
  std::string column;  ///< "stress" or "fabric"
  std::string why;
};

/// The first of stress ratio and fabric whose mean over the first shear, its beginning left out, lies across it by more than 0.7 of what lies
/// along it and `scatter`, while it would point along with a sign turned or other columns: an honest packing that is off, a crystal or one
/// of few spheres, would not. Fabric that is not told is not judged.
std::optional<Misdirection> misdirection(const std::vector<Observation>& rows,
                                         const std::vector<StraightSegment>& segments, double scatter);

}  // namespace grainlaw
