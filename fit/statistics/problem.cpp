#include "fit/statistics/problem.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "model/parameters.hpp"
#include "model/side_by_side.hpp"

namespace grainlaw::fit {
namespace {

bool finite(const double* from, std::ptrdiff_t n) {
  return std::all_of(from, from + n, [](double v) { return std::isfinite(v); });
}

}  // namespace

FreeParameter free_parameter(const std::string& name, double start) {
  const ParameterInfo& info = parameter_table()[parameter_index(name)];
  const double scale = std::max(std::abs(start), 1e-3 * (info.upper - info.lower));
  return {name, start, info.lower, info.upper, scale};
}

int row_count(const std::vector<ResidualBlock>& blocks) {
  int rows = 0;
  for (const ResidualBlock& block : blocks) rows += block.rows();
  return rows;
}

bool evaluate(const std::vector<ResidualBlock>& blocks, const Eigen::VectorXd& x, int threads, double* misfit,
              double* jacobian) {
  std::vector<std::ptrdiff_t> first;
  std::ptrdiff_t rows = 0;
  for (const ResidualBlock& block : blocks) {
    first.push_back(rows);
    rows += block.rows();
  }
  std::fill(misfit, misfit + rows, std::nan(""));
  std::atomic<bool> good = true;
  side_by_side(blocks.size(), threads, [&](std::size_t b) {
    double* J = jacobian == nullptr ? nullptr : jacobian + first[b] * x.size();
    if (!blocks[b].evaluate(x.data(), misfit + first[b], J)) good = false;
  });
  return good && finite(misfit, rows) && (jacobian == nullptr || finite(jacobian, rows * x.size()));
}

}  // namespace grainlaw::fit
