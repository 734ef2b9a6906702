#pragma once
// The law with one parameter a little larger and a little smaller: derivatives by central differences,
//   df/dp = (f(p + h) - f(p - h))/(2h),   h = eps^(1/3) of the parameter's magnitude,
// where truncation, h^2 f'''/6, and rounding, eps f/h, are of one size.

#include <cstddef>
#include <vector>

#include "model/parameters.hpp"

namespace grainlaw::predict {

struct ParameterStep {
  double magnitude = 0;                ///< of the parameter: its value, or where a fit would start if that is larger
  double h = 0;                        ///< step [-]
  LawParameters<double> above, below;  ///< with p + h and p - h
};

/// One for each index in parameter_table().
std::vector<ParameterStep> parameter_steps(const LawParameters<double>& parameters,
                                           const std::vector<std::size_t>& indices);

}  // namespace grainlaw::predict
