#include "predict/parameter_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::predict {

std::vector<ParameterStep> parameter_steps(const LawParameters<double>& parameters,
                                           const std::vector<std::size_t>& indices) {
  std::vector<ParameterStep> steps;
  for (const std::size_t i : indices) {
    ParameterStep step{0, 0, parameters, parameters};
    const double value = *fields(parameters)[i], start = std::abs(parameter_table()[i].start);
    step.magnitude = std::max(std::abs(value), start > 0 ? start : 1.0);
    step.h = std::cbrt(std::numeric_limits<double>::epsilon()) * step.magnitude;
    *fields(step.above)[i] = value + step.h;
    *fields(step.below)[i] = value - step.h;
    steps.push_back(step);
  }
  return steps;
}

}  // namespace grainlaw::predict
