#pragma once
// Student's t distribution: how many standard errors an interval reaches to either side when the error itself is known
// from few packings.

namespace grainlaw {

/// t with P(T <= t) = `probability`, 0.5 <= probability < 1. `degrees_of_freedom` >= 0.1, not necessarily whole;
/// infinity: the normal distribution's. Throws InvalidInput otherwise.
double student_quantile(double probability, double degrees_of_freedom);

/// Standard errors on either side of a 95 % interval.
double student_95(double degrees_of_freedom);

}  // namespace grainlaw
