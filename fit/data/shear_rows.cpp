#include "fit/data/shear_rows.hpp"

#include <algorithm>
#include <cmath>

namespace grainlaw::fit {
namespace {

constexpr double kStart = 1e-12;          // strain up to which a row is the start itself
constexpr double kStrainRounding = 1e-9;  // a row meant to lie on a window's end belongs to it

double weight_of(std::size_t rows) { return 1 / std::sqrt(static_cast<double>(std::max(rows, kFullWindow))); }

}  // namespace

RowWeights shear_window(const std::vector<double>& eps_dev, const CalibrationOptions& options) {
  const auto in_rate = [&](double e) { return e > kStart && e <= options.rate_window + kStrainRounding; };
  const auto in_steady = [&](double e) { return e >= options.steady_from - kStrainRounding && !in_rate(e); };
  const auto rate = static_cast<std::size_t>(std::count_if(eps_dev.begin(), eps_dev.end(), in_rate));
  const auto steady = static_cast<std::size_t>(std::count_if(eps_dev.begin(), eps_dev.end(), in_steady));
  RowWeights rows;
  for (std::size_t i = 0; i < eps_dev.size(); ++i) {
    if (!in_rate(eps_dev[i]) && !in_steady(eps_dev[i])) continue;
    rows.row.push_back(i);
    rows.weight.push_back(in_rate(eps_dev[i]) ? weight_of(rate) : options.steady_weight * weight_of(steady));
  }
  return rows;
}

RowWeights whole_window(const std::vector<double>& strain) {
  RowWeights rows;
  for (std::size_t i = 0; i < strain.size(); ++i) {
    if (strain[i] > kStart) rows.row.push_back(i);
  }
  rows.weight.assign(rows.row.size(), weight_of(rows.row.size()));
  return rows;
}

}  // namespace grainlaw::fit
