#include "app/report/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace grainlaw::app::report {
namespace {

/// True for 1, 2 or 5 times a power of ten.
bool is_round(double step) {
  const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
  return std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 || std::abs(mantissa - 5) < 1e-6;
}

TEST(ReportAxis, LinearTicksAreRoundEvenAndInside) {
  for (const auto& [lowest, highest] :
       {std::pair{0.0, 1.0}, {0.6581, 0.82}, {-0.031, 0.007}, {1e-9, 3e-9}, {-4e7, 9e8}}) {
    for (const int wanted : {3, 4, 5, 8}) {
      const Axis axis = linear_axis(lowest, highest, wanted);
      EXPECT_LT(axis.from, lowest);
      EXPECT_GT(axis.to, highest);
      ASSERT_GE(axis.ticks.size(), 2U);
      EXPECT_LE(axis.ticks.size(), 2U * static_cast<std::size_t>(wanted) + 2);
      const double step = axis.ticks[1].value - axis.ticks[0].value;
      EXPECT_TRUE(is_round(step)) << step;
      std::set<std::string> labels;
      for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
        const double value = axis.ticks[i].value;
        EXPECT_NEAR(value / step, std::round(value / step), 1e-6);
        EXPECT_GE(value, axis.from - 1e-9 * (axis.to - axis.from));
        EXPECT_LE(value, axis.to + 1e-9 * (axis.to - axis.from));
        labels.insert(to_plain(axis.ticks[i].label));
      }
      EXPECT_EQ(labels.size(), axis.ticks.size()) << "labels must differ";
    }
  }
}

TEST(ReportAxis, EndsMapToZeroAndOne) {
  const Axis linear = linear_axis(0.2, 0.8, 5, true);
  EXPECT_EQ(linear.from, 0.2);
  EXPECT_EQ(linear.to, 0.8);
  EXPECT_NEAR(linear.fraction(0.5), 0.5, 1e-15);
  const Axis decades = logarithmic_axis(3e-5, 0.2);
  EXPECT_NEAR(decades.from, 1e-5, 1e-19);
  EXPECT_NEAR(decades.to, 1, 1e-14);
  EXPECT_NEAR(decades.fraction(1e-5), 0, 1e-14);
  EXPECT_NEAR(decades.fraction(1e-3), 0.4, 1e-14);
}

TEST(ReportAxis, ARangeWithoutExtentIsWidened) {
  for (const double value : {0.0, 0.7, -3.0}) {
    const Axis axis = linear_axis(value, value);
    EXPECT_LT(axis.from, value);
    EXPECT_GT(axis.to, value);
    EXPECT_FALSE(axis.ticks.empty());
  }
  const Axis decade = logarithmic_axis(0.1, 0.1);
  EXPECT_LT(decade.from, decade.to);
}

TEST(ReportAxis, LogarithmicTicksAreDecades) {
  const Axis axis = logarithmic_axis(2e-9, 30, 6);
  int labelled = 0;
  for (const Tick& tick : axis.ticks) {
    if (tick.label.runs.empty()) continue;
    ++labelled;
    EXPECT_NEAR(std::log10(tick.value), std::round(std::log10(tick.value)), 1e-9);
  }
  EXPECT_GE(labelled, 3);
  EXPECT_LE(labelled, 7);
}

TEST(ReportAxis, WhatIsNotFiniteOrNotPositiveIsUndefined) {
  EXPECT_FALSE(linear_axis(0, 1).defined_at(std::nan("")));
  EXPECT_FALSE(linear_axis(0, 1).defined_at(INFINITY));
  EXPECT_TRUE(linear_axis(0, 1).defined_at(-5));
  EXPECT_FALSE(logarithmic_axis(0.1, 1).defined_at(0));
  EXPECT_FALSE(logarithmic_axis(0.1, 1).defined_at(-1));
}

}  // namespace
}  // namespace grainlaw::app::report
