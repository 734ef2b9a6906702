#pragma once
// Independent pieces of work in as many ranges as there are threads.

#include <algorithm>
#include <cstddef>

#include "model/side_by_side.hpp"

namespace grainlaw::predict {

/// Calls work(first, end) of as many ranges as threads that cover [0, count). Throws what the first failing range
/// throws, when all have ended.
template <class Work>
void in_ranges(std::size_t count, int threads, const Work& work) {
  const std::size_t ranges = std::clamp<std::size_t>(count, 1, static_cast<std::size_t>(std::max(threads, 1)));
  side_by_side(ranges, threads, [&](std::size_t range) { work(count * range / ranges, count * (range + 1) / ranges); });
}

}  // namespace grainlaw::predict
