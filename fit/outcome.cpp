#include "fit/outcome.hpp"

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::fit {

double Estimate::half_width() const {
  if (!std::isfinite(standard_error) || std::isnan(degrees_of_freedom)) return std::nan("");
  return student_95(degrees_of_freedom) * standard_error;
}

}  // namespace grainlaw::fit
