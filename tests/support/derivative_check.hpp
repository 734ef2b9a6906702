#pragma once
// The derivative of a function by Ridders' extrapolation of central differences, to check a law's value and derivative
// against each other: f'(x) = lim (f(x+h) - f(x-h))/(2h), Neville's scheme over h, h/1.4, h/1.4^2, ...

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace grainlaw::testing {

struct DerivativeEstimate {
  double value = 0;
  double error = std::numeric_limits<double>::infinity();  ///< estimated absolute error of `value`
};

/// df/dx at `x` from evaluations within `h` > 0 of it, inside of which f must be smooth.
template <class F>
DerivativeEstimate ridders_derivative(F&& f, double x, double h) {
  constexpr double shrink = 1.4;
  constexpr std::size_t columns = 12;
  std::array<std::array<double, columns>, columns> table{};
  DerivativeEstimate best;
  for (std::size_t i = 0; i < columns; ++i, h /= shrink) {
    const double above = x + h, below = x - h;
    table[0][i] = (f(above) - f(below)) / (above - below);
    double factor = shrink * shrink;
    for (std::size_t j = 1; j <= i; ++j, factor *= shrink * shrink) {
      table[j][i] = (table[j - 1][i] * factor - table[j - 1][i - 1]) / (factor - 1);
      const double error =
          std::max(std::abs(table[j][i] - table[j - 1][i]), std::abs(table[j][i] - table[j - 1][i - 1]));
      if (error <= best.error) best = {table[j][i], error};
    }
    if (i > 0 && std::abs(table[i][i] - table[i - 1][i - 1]) >= 2 * best.error) break;
  }
  return best;
}

/// |claimed - df/dx|/max(|df/dx|, floor): how far a claimed derivative is off.
template <class F>
double derivative_error(F&& f, double claimed, double x, double h, double floor = 0) {
  const DerivativeEstimate estimate = ridders_derivative(f, x, h);
  const double scale = std::max(std::abs(estimate.value), floor);
  return scale > 0 ? std::abs(claimed - estimate.value) / scale : std::abs(claimed);
}

}  // namespace grainlaw::testing
