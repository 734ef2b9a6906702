#pragma once
// Memory of large scenes on large pages, where the system has them: with small ones a pass over a million spheres waits for
// the addresses of its pages.

#include <cstddef>
#include <vector>

namespace grainlaw::dem {

/// Asks the system to put memory that has not been touched yet on large pages; less than a few of them are left alone.
void ask_for_large_pages(void* begin, std::size_t bytes);

/// v.reserve(n), but what was in v is lost when it must move.
template <class T, class Allocator>
void reserve_on_large_pages(std::vector<T, Allocator>& v, std::size_t n) {
  if (n <= v.capacity()) return;
  v = {};
  v.reserve(n);
  ask_for_large_pages(v.data(), n * sizeof(T));
}

}  // namespace grainlaw::dem
