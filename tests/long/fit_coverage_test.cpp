// Hard case F2 for the coupled fit: white noise of 1 % on 1000 data sets.

#include <gtest/gtest.h>

#include "tests/support/fit_coverage.hpp"

namespace grainlaw {
namespace {

TEST(Coverage, F2Evolution) { testing::coverage_figures(testing::coverage_of_evolution(1000, 9000)); }

}  // namespace
}  // namespace grainlaw
