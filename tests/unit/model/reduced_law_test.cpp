#include "model/reduced_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/derivative_check.hpp"

namespace grainlaw {
namespace {

TEST(ReducedLaw, BeginsAtTheStartAndEndsAtTheLimit) {
  EXPECT_NEAR(saturating(0.17, 0.02, 50.0, 0.0), 0.02, 1e-16);
  EXPECT_NEAR(saturating(0.17, 0.02, 50.0, 10.0), 0.17, 1e-16);
  EXPECT_NEAR(saturating(0.17, 0.02, 50.0, 1 / 50.0), 0.17 - 0.15 / std::exp(1.0), 1e-16);
}

TEST(ReducedLaw, SolvesItsEquation) {
  // d/de = rate (limit - value)
  const auto value = [](double e) { return saturating(0.17, -0.05, 50.0, e); };
  for (const double e : {0.001, 0.02, 0.1}) {
    EXPECT_LE(testing::derivative_error(value, 50 * (0.17 - value(e)), e, 5e-4), 1e-9) << e;
  }
}

TEST(ReducedLaw, ReadsTheParametersOfItsOwnQuantityAtTheGivenDensity) {
  const LawParameters<double> p = published_parameters();
  const double y = 0.72 / p.shear_nu_c - 1, e = 0.03;
  const double s_max = 0.1137 + 0.09166 * std::exp(-7.916 * y), beta_s = 30.76 + 57.0 * std::exp(-16.86 * y);
  const double F_max = 0.1694 * std::exp(-4.562 * y), beta_F = 57.89 * std::exp(-5.366 * y);
  EXPECT_NEAR(reduced_stress_ratio(p, 0.72, 0.01, e), s_max - (s_max - 0.01) * std::exp(-beta_s * e), 1e-15);
  EXPECT_NEAR(reduced_fabric(p, 0.72, 0.02, e), F_max - (F_max - 0.02) * std::exp(-beta_F * e), 1e-15);
}

}  // namespace
}  // namespace grainlaw
