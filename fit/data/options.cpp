#include "fit/data/options.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {

void check(const CalibrationOptions& options) {
  const auto positive = [](double value, const char* field) {
    if (!(std::isfinite(value) && value > 0)) {
      throw InvalidInput(fmt::format("calibration options: {} is {}; give a positive number", field, value));
    }
  };
  positive(options.iso_nu_min, "iso_nu_min");
  positive(options.rate_window, "rate_window");
  positive(options.steady_from, "steady_from");
  positive(options.steady_weight, "steady_weight");
  positive(options.stiffness_window, "stiffness_window");
  positive(options.lag_window, "lag_window");
  positive(options.max_step, "max_step");
  positive(options.pressure_scale, "pressure_scale");
  positive(options.stress_scale, "stress_scale");
  positive(options.fabric_scale, "fabric_scale");
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
