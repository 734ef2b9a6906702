#include "model/student.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

// Closed forms with u = p - 1/2: n = 1: tan(pi u);  n = 2: u sqrt(2/(1/4 - u^2));  n = 4: 2 sqrt(cos(acos(w)/3)/w - 1) with
// w = sqrt(1 - 4 u^2).
TEST(Student, ClosedFormsOfOneTwoAndFourDegreesOfFreedom) {
  for (const double p : {0.51, 0.6, 0.75, 0.9, 0.975, 0.999, 0.999999}) {
    const double u = p - 0.5, w = std::sqrt(1 - 4 * u * u);
    const double one = std::tan(std::numbers::pi * u), two = u * std::sqrt(2 / (0.25 - u * u));
    const double four = 2 * std::sqrt(std::cos(std::acos(w) / 3) / w - 1);
    EXPECT_NEAR(student_quantile(p, 1), one, 1e-8 * one) << p;
    EXPECT_NEAR(student_quantile(p, 2), two, 1e-8 * two) << p;
    EXPECT_NEAR(student_quantile(p, 4), four, 1e-8 * four) << p;
  }
}

TEST(Student, NormalInTheLimit) {
  const double z = student_95(std::numeric_limits<double>::infinity());
  EXPECT_NEAR(std::erfc(z / std::sqrt(2.0)), 0.05, 1e-14);
  // The leading correction is z (z^2 + 1)/(4 n).
  for (const double n : {1e3, 1e4}) EXPECT_NEAR(student_95(n), z + z * (z * z + 1) / (4 * n), 5 / (n * n)) << n;
  EXPECT_NEAR(student_95(1e8 - 1), student_95(1e8), 1e-7);
}

TEST(Student, FallsWithTheDegreesOfFreedomBetweenWholeOnesToo) {
  double last = std::numeric_limits<double>::infinity();
  for (double n = 0.5; n < 300; n *= 1.1) {
    const double t = student_95(n);
    EXPECT_LT(t, last) << n;
    last = t;
  }
  EXPECT_EQ(student_quantile(0.5, 3), 0);
}

TEST(Student, RefusesWhatIsNoProbability) {
  EXPECT_THROW(student_quantile(1, 3), InvalidInput);
  EXPECT_THROW(student_quantile(0.4, 3), InvalidInput);
  EXPECT_THROW(student_quantile(0.9, 0), InvalidInput);
  EXPECT_THROW(student_quantile(std::nan(""), 3), InvalidInput);
  EXPECT_THROW(student_95(std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace grainlaw
