#include "dem/runs/engine_path.hpp"

#include <fmt/format.h>

#include "dem/element_tests/drive.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

std::vector<StraightSegment> engine_path(const Path& path, const std::string& name) {
  try {
    std::vector<StraightSegment> segments = resolve(path);
    check_can_follow(segments);
    return segments;
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace grainlaw::dem
