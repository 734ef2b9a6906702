#pragma once
// Independent pieces of work on several threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace grainlaw {

/// Calls work(k) once for each k < count, `threads` at a time, this thread being one of them. When all have ended, throws what the
/// first of them that failed has thrown.
template <class Work>
void side_by_side(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::exception_ptr> failures(count);
  const auto one_after_another = [&] {
    for (std::size_t k = next++; k < count; k = next++) {
      try {
        work(k);
      } catch (...) {
        failures[k] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (int t = 1; t < threads && static_cast<std::size_t>(t) < count; ++t) others.emplace_back(one_after_another);
    one_after_another();
  }
  const auto failure = std::ranges::find_if(failures, [](const std::exception_ptr& each) { return each != nullptr; });
  if (failure != failures.end()) std::rethrow_exception(*failure);
}

}  // namespace grainlaw
