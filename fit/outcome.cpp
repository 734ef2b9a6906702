#include "fit/outcome.hpp"

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::fit {

std::string to_string(Status status) {
  switch (status) {
    case Status::fitted:
      return "fitted";
    case Status::fixed:
      return "fixed";
    case Status::tied:
      return "tied";
    case Status::at_bound:
      return "at_bound";
    case Status::not_identified:
      break;
  }
  return "not_identified";
}

double Estimate::half_width() const {
  if (!std::isfinite(standard_error) || std::isnan(degrees_of_freedom)) return std::nan("");
  return student_95(degrees_of_freedom) * standard_error;
}

}  // namespace grainlaw::fit
