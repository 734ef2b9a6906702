// D19 in full: the neighbour list against all pairs in 10^6 random configurations, 0 missed, 0 double. The quick
// version and the description are in tests/verification/dem/pair_list_test.cpp.

#include <gtest/gtest.h>

#include "tests/support/dem_pair_list.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

TEST(PairListLong, D19MillionConfigurations) {
  const scene::ListFaults faults = scene::random_list_faults(1000000, 42);
  EXPECT_GT(faults.looked_for, 1000000) << "else there was little to miss";
  testing::expect_figure("D19.missed.million", static_cast<double>(faults.missed), 0);
  testing::expect_figure("D19.double.million", static_cast<double>(faults.twice), 0);
  testing::expect_figure("D19.invented.million", static_cast<double>(faults.invented), 0);
}

}  // namespace
}  // namespace grainlaw::dem
