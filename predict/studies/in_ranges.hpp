#pragma once
// Independent pieces of work in as many ranges as there are threads.

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace grainlaw::predict {

/// Calls work(first, end) of ranges that cover [0, count), each on a thread of its own. Throws what the first failing range
/// throws, when all have ended.
template <class Work>
void in_ranges(std::size_t count, int threads, const Work& work) {
  const std::size_t ranges = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), 1,
                                                     std::max<std::size_t>(count, 1));
  std::vector<std::exception_ptr> failures(ranges);
  const auto one = [&](std::size_t range) {
    try {
      work(count * range / ranges, count * (range + 1) / ranges);
    } catch (...) {
      failures[range] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t range = 1; range < ranges; ++range) others.emplace_back(one, range);
    one(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace grainlaw::predict
