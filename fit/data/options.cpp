#include "fit/data/options.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {

void check(const CalibrationOptions& options) {
  for_each_field<CalibrationOptions>([&](const auto& field) {
    const auto& value = std::invoke(field.access, options);
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>) {
      if (!(std::isfinite(value) && value > 0))
        throw InvalidInput(fmt::format("calibration options: {} is {}; give a positive number", field.name, value));
    }
  });
  if (options.steady_from < options.rate_window) {
    throw InvalidInput(fmt::format("calibration options: steady_from {} lies before rate_window {}",
                                   options.steady_from, options.rate_window));
  }
  if (options.starts < 1) {
    throw InvalidInput(fmt::format("calibration options: starts is {}; give at least 1", options.starts));
  }
  if (options.threads < 1) {
    throw InvalidInput(fmt::format("calibration options: threads is {}; give at least 1", options.threads));
  }
}

}  // namespace grainlaw::fit
