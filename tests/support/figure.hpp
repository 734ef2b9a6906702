#pragma once
// A measured figure with its pass line: checked by the test that measures it and printed for scripts as
//   figure NAME VALUE BOUND
// which means VALUE <= BOUND. It is also recorded as a property of the test (XML and JSON reports of GoogleTest).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace grainlaw::testing {

/// Prints and records `value`, and fails the running test unless it is finite and at most `bound`.
/// `name` has no blanks, e.g. "D1.max".
inline void expect_figure(const std::string& name, double value, double bound) {
  fmt::print("figure {} {:.3e} {:.3e}\n", name, value, bound);
  std::fflush(stdout);
  ::testing::Test::RecordProperty(name, fmt::format("{:.17g} <= {:.17g}", value, bound));
  EXPECT_TRUE(std::isfinite(value)) << "figure " << name;
  EXPECT_LE(value, bound) << "figure " << name;
}

}  // namespace grainlaw::testing
