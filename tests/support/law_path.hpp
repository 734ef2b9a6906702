#pragma once
// Strain paths for tests of the law, short to write.

#include <vector>

#include "model/vocabulary/path.hpp"

namespace grainlaw::testing {

/// One segment of a mode over a deviatoric strain, or a volumetric one in ISO.
inline PathSegment leg(Mode mode, double strain, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), mode == Mode::ISO ? ExtentKind::eps_vol : ExtentKind::eps_dev,
          strain};
}

/// One segment of a mode up (or down) to a volume fraction.
inline PathSegment leg_to(Mode mode, double nu, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), ExtentKind::target_nu, nu};
}

inline Path path_of(double nu, std::vector<PathSegment> legs) { return {nu, Branch::unloading, std::move(legs)}; }

inline std::vector<StraightSegment> path_from(double nu, std::vector<PathSegment> legs) {
  return resolve(path_of(nu, std::move(legs)));
}

/// D2 to and fro: `corners` reversals divide the deviatoric strain `total` into equal parts.
inline std::vector<StraightSegment> reversals(double nu, int corners, double total) {
  std::vector<PathSegment> legs;
  for (int i = 0; i <= corners; ++i) legs.push_back(leg(Mode::D2, total / (corners + 1), i % 2 == 1));
  return path_from(nu, std::move(legs));
}

}  // namespace grainlaw::testing
