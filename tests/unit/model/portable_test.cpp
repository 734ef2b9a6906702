#include "model/vocabulary/portable.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/figure.hpp"

namespace grainlaw {
namespace {

using Many = boost::multiprecision::cpp_bin_float_100;

// Against a hundred digits: correctly rounded functions have the same bits wherever they are made.
TEST(Portable, IsCorrectlyRounded) {
  std::mt19937_64 engine(5);
  const auto draw = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); };
  int wrong = 0, compared = 0;
  const auto compare = [&](const char* name, double x, double ours, const Many& exact) {
    ++compared;
    if (ours == static_cast<double>(exact)) return;
    ++wrong;
    ADD_FAILURE() << name << "(" << ::testing::PrintToString(x) << ") = " << ours;
  };
  for (int k = 0; k < 4000; ++k) {
    for (const double range : {1e-8, 1e-3, 1.0, 20.0}) {
      const double x = draw(-range, range);
      compare("exp", x, portable::exp(x), exp(Many(x)));
      compare("expm1", x, portable::expm1(x), boost::multiprecision::expm1(Many(x)));
    }
    for (const double range : {1e-8, 1e-3, 0.9}) {
      const double x = draw(-range, range);
      compare("log1p", x, portable::log1p(x), boost::multiprecision::log1p(Many(x)));
      compare("acos", x, portable::acos(x), acos(Many(x)));
    }
    const double x = draw(1e-3, 1e3), angle = draw(-7, 7);
    compare("log", x, portable::log(x), log(Many(x)));
    compare("cbrt", x, portable::cbrt(x), cbrt(Many(x)));
    compare("log", 1 + 1e-6 * angle, portable::log(1 + 1e-6 * angle), log(Many(1 + 1e-6 * angle)));
    compare("sin", angle, portable::sin(angle), sin(Many(angle)));
    compare("cos", angle, portable::cos(angle), cos(Many(angle)));
  }
  testing::expect_figure("portable.wrongly_rounded", wrong, 0);
  EXPECT_GT(compared, 70000);
}

TEST(Portable, IsExactWhereTheValueIs) {
  EXPECT_EQ(portable::exp(0), 1);
  EXPECT_EQ(portable::expm1(0), 0);
  EXPECT_EQ(portable::log(1), 0);
  EXPECT_EQ(portable::log1p(0), 0);
  EXPECT_EQ(portable::sin(0), 0);
  EXPECT_EQ(portable::cos(0), 1);
  EXPECT_EQ(portable::acos(1), 0);
  EXPECT_EQ(portable::acos(-1), std::numbers::pi);
  for (const double x : {1.0, 8.0, 27.0, 9261.0, 1e-9})
    EXPECT_EQ(portable::cbrt(x), std::round(std::cbrt(x) * 1e3) / 1e3);
  EXPECT_EQ(portable::cos(std::numbers::pi), -1);
}

}  // namespace
}  // namespace grainlaw
