#pragma once
// Where a residual is differentiated for a check: points of a problem's parameter space, bounds included.

#include <algorithm>
#include <random>
#include <vector>

#include "fit/statistics/least_squares.hpp"
#include "fit/statistics/problem.hpp"
#include "tests/support/derivative_check.hpp"

namespace grainlaw::testing {

class RandomPoints {
 public:
  explicit RandomPoints(std::uint64_t seed) : engine_(seed) {}

  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  std::size_t index(std::size_t size) { return std::uniform_int_distribution<std::size_t>(0, size - 1)(engine_); }

  /// Near the parameters' starts, within their bounds; one coordinate in five points lies on a bound.
  std::vector<double> near(const std::vector<fit::FreeParameter>& parameters) {
    std::vector<double> x;
    for (const fit::FreeParameter& p : parameters) {
      const bool density = p.name.size() > 5 && p.name.compare(p.name.size() - 5, 5, ".nu_c") == 0;
      const double spread = density ? 0.005 : 0.5 * std::max(std::abs(p.start), p.scale);
      x.push_back(std::clamp(p.start + uniform(-spread, spread), p.lower, p.upper));
    }
    if (uniform(0, 1) < 0.2) {
      const std::size_t k = index(x.size());
      const double lower = parameters[k].lower, upper = parameters[k].upper;
      // The nearer bound: at the other end of a wide range (a rate of 500, nu_c = 0.5) no packing was ever seen.
      x[k] = x[k] - lower < upper - x[k] ? lower : upper;
    }
    return x;
  }

 private:
  std::mt19937_64 engine_;
};

/// |claimed - Ridders| for one column of a block's Jacobian at `x`, all rows at once by a random combination, relative to
/// the magnitude of the column. `step`: half width within which the block is smooth in this parameter. Negative when the
/// model is not defined there.
inline double column_error(const fit::ResidualBlock& block, std::vector<double> x, std::size_t column, double step,
                           RandomPoints& random) {
  const auto rows = static_cast<std::size_t>(block.rows());
  std::vector<double> misfit(rows), jacobian(rows * x.size()), combination(rows);
  if (!block.evaluate(x.data(), misfit.data(), jacobian.data())) return -1;
  double claimed = 0, magnitude = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    combination[i] = random.uniform(-1, 1);
    claimed += combination[i] * jacobian[i * x.size() + column];
    magnitude += std::abs(combination[i] * jacobian[i * x.size() + column]);
  }
  bool defined = true;
  const auto value = [&](double at) {
    x[column] = at;
    defined = block.evaluate(x.data(), misfit.data(), nullptr) && defined;
    double sum = 0;
    for (std::size_t i = 0; i < rows; ++i) sum += combination[i] * misfit[i];
    return sum;
  };
  // The best of several widths: too wide, and the extrapolation meets curvature; too narrow, and rounding.
  const double centre = x[column];
  DerivativeEstimate best;
  for (double width = 2 * step; width > step / 300; width /= 3) {
    const DerivativeEstimate estimate = ridders_derivative(value, centre, width);
    if (estimate.error < best.error) best = estimate;
  }
  const double error = magnitude > 0 ? std::abs(claimed - best.value) / magnitude : std::abs(best.value);
  return defined ? error : -1;
}

}  // namespace grainlaw::testing
