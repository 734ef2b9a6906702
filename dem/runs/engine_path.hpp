#pragma once
// Paths for the engine: strain-controlled, with cells that stay upright.

#include <string>
#include <vector>

#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

/// The straight segments of `path`. Throws InvalidInput with the file's `name` in front for what resolve() refuses and
/// for segments that the engine cannot follow.
std::vector<StraightSegment> engine_path(const Path& path, const std::string& name);

}  // namespace grainlaw::dem
