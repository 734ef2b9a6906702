// Hard case F2, white noise of 1 % on 1000 data sets, for all that one fit of a curve over density determines. The coupled
// fit is in tests/long.

#include <gtest/gtest.h>

#include "tests/support/fit_coverage.hpp"

namespace grainlaw {
namespace {

TEST(Coverage, F2IsotropicLaws) { testing::coverage_figures(testing::coverage_of_isotropic_laws(1000, 1000)); }

TEST(Coverage, F2SteadyLaws) { testing::coverage_figures(testing::coverage_of_steady_laws(1000, 5000)); }

}  // namespace
}  // namespace grainlaw
