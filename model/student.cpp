#include "model/student.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "model/error.hpp"

namespace grainlaw {
namespace {

constexpr double kNormal = 1e8;  // degrees of freedom from which the two distributions agree to rounding

/// Continued fraction of the incomplete beta function (Abramowitz & Stegun, 26.5.8) by Lentz's method; converges fast for
/// x < (a + 1)/(a + b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double fraction = d;
  for (int m = 1; m < 100000; ++m) {
    double change = 1;
    for (const double term : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                              -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
      d = 1 + term * d;
      d = 1 / (std::abs(d) < tiny ? tiny : d);
      c = 1 + term / c;
      if (std::abs(c) < tiny) c = tiny;
      change = c * d;
      fraction *= change;
    }
    if (std::abs(change - 1) < 1e-15) break;
  }
  return fraction;
}

/// I_x(a, b); `y` is 1 - x, given because it may be tiny.
double incomplete_beta(double a, double b, double x, double y) {
  if (!(x > 0)) return 0;
  if (!(y > 0)) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, y) / b;
}

/// P(T > t), t >= 0.
double upper_tail(double t, double n) {
  if (n >= kNormal) return std::erfc(t / std::sqrt(2.0)) / 2;
  const double t2 = t * t;
  return incomplete_beta(n / 2, 0.5, n / (n + t2), t2 / (n + t2)) / 2;
}

}  // namespace

double student_quantile(double probability, double degrees_of_freedom) {
  if (!(probability >= 0.5 && probability < 1 && degrees_of_freedom >= 0.1)) {
    throw InvalidInput(fmt::format("Student's t: no quantile at probability {} with {} degrees of freedom", probability,
                                   degrees_of_freedom));
  }
  const double tail = 1 - probability;
  double low = 0, high = 1;
  while (upper_tail(high, degrees_of_freedom) > tail) high *= 2;
  while (high - low > 4 * std::numeric_limits<double>::epsilon() * high) {
    const double middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    (upper_tail(middle, degrees_of_freedom) > tail ? low : high) = middle;
  }
  return (low + high) / 2;
}

double student_95(double degrees_of_freedom) { return student_quantile(0.975, degrees_of_freedom); }

}  // namespace grainlaw
