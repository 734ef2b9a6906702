#include "model/student.hpp"

#include <fmt/format.h>

#include <boost/math/distributions/students_t.hpp>

#include "model/vocabulary/error.hpp"

namespace grainlaw {

double student_quantile(double probability, double degrees_of_freedom) {
  if (!(probability >= 0.5 && probability < 1 && degrees_of_freedom >= 0.1)) {
    throw InvalidInput(fmt::format("Student's t: no quantile at probability {} with {} degrees of freedom", probability,
                                   degrees_of_freedom));
  }
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), probability);
}

double student_95(double degrees_of_freedom) { return student_quantile(0.975, degrees_of_freedom); }

}  // namespace grainlaw
