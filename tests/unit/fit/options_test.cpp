#include "fit/data/options.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

std::string refusal_of(const CalibrationOptions& options) {
  try {
    check(options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(CalibrationOptions, DefaultsAreValid) { EXPECT_EQ(refusal_of({}), ""); }

TEST(CalibrationOptions, RefusalsNameTheField) {
  CalibrationOptions o;
  o.max_step = std::nan("");
  EXPECT_NE(refusal_of(o).find("max_step"), std::string::npos);
  o = {};
  o.stress_scale = 0;
  EXPECT_NE(refusal_of(o).find("stress_scale"), std::string::npos);
  o = {};
  o.steady_from = 0.1;
  EXPECT_NE(refusal_of(o).find("steady_from"), std::string::npos);
  o = {};
  o.threads = 0;
  EXPECT_NE(refusal_of(o).find("threads"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::fit
