#pragma once
// What no reader, law or result may take or give.

#include <limits>

namespace grainlaw::testing {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace grainlaw::testing
