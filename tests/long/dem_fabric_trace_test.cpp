// D13 at N = 9261: tr F = g3 nu C within 3 %. The formula is in tests/support/dem_contact_statistics.hpp, the quick
// version in tests/verification/dem/contact_numbers_test.cpp.

#include <gtest/gtest.h>

#include "tests/support/dem_contact_statistics.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

TEST(FabricTraceLong, D13TraceFollowsCoordinationAndSizes) {
  for (const double nu : {0.70, 0.75, 0.82}) {
    testing::expect_figure(fmt::format("D13.statistical.N9261.nu{:.2f}", nu), scene::fabric_error(9261, nu), 0.03);
  }
}

}  // namespace
}  // namespace grainlaw::dem
