// The right-hand side takes nothing from the heap: operator new of this executable counts.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "predict/predict.hpp"
#include "predict/segment_law.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"

namespace {
std::atomic<long> allocations{0};
}

// Not inlined: g++ would see free() meet what a new-expression gave.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace grainlaw::predict {
namespace {

TEST(Allocation, OfTheRightHandSideIsNone) {
  const LawParameters<double> p = published_parameters();
  const auto path = testing::path_from(0.70, {testing::leg_to(Mode::UNI, 0.80)});
  const LawState<double> start = state_from_law(p, 0.70);

  const long before_one = allocations;
  ::operator delete(::operator new(1));
  EXPECT_EQ(allocations - before_one, 1) << "the counter counts";

  long taken = 0;
  for (const Rung rung : kRungs) {
    for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
      const SegmentLaw law(p, rung, coupling, path[0], 1e-12);
      Unknowns y = law.unknowns_of(0, start), rate, scale;
      const long before = allocations;
      for (int i = 0; i < 1000; ++i) {
        const double e = path[0].length * i / 1000;
        law.rate(e, y.data(), rate.data());
        law.scale(e, y.data(), scale.data());
        y[1] += 1e-9 * rate[1];
      }
      taken += allocations - before;
    }
  }
  testing::expect_figure("law.allocations_of_the_right_hand_side", static_cast<double>(taken), 0);
}

}  // namespace
}  // namespace grainlaw::predict
