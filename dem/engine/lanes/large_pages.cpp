#include "dem/engine/lanes/large_pages.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <cstdint>

namespace grainlaw::dem {

void ask_for_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::uintptr_t large = 2 << 20;
  const auto first = (reinterpret_cast<std::uintptr_t>(begin) + large - 1) / large * large;
  const auto last = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / large * large;
  if (last < first + 4 * large) return;
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);  // only advice: nothing is lost when it is not taken
#endif
}

}  // namespace grainlaw::dem
