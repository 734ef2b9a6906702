#include "fit/data/shear_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::fit {
namespace {

constexpr double kStart = 1e-12;          // strain up to which a row is the start itself
constexpr double kStrainRounding = 1e-9;  // a row meant to lie on a window's end belongs to it

constexpr std::size_t kFewestRows = 8;      // of a series of which one can tell that it is steady
constexpr double kUnjammedPressure = 1e-5;  // P* of x = ln(nu/nu_c) = 4e-5 by Eq. (14)

double weight_of(std::size_t rows) { return 1 / std::sqrt(static_cast<double>(std::max(rows, kFullWindow))); }

}  // namespace

LawState<double> measured_state(const TestRecord& test, const Observation& row) {
  return {row.P_star, deviator<double>(row.stress.tensor) / test.packing.stress_unit(),
          deviator<double>(row.fabric.tensor)};
}

bool is_like_D2(double lode) { return std::abs(lode) < 0.5; }

bool is_jammed(const Observation& row) { return row.P_star > kUnjammedPressure; }

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

int steady_row(const std::vector<double>& x) {
  if (x.size() < kFewestRows) return -1;
  const std::size_t last = x.size() / 2;
  std::size_t best = last;
  double least = std::numeric_limits<double>::infinity(), sum = 0, squares = 0, n = 0;
  const double shift = x.back();  // so that the sums of squares keep their digits
  for (std::size_t d = x.size(); d-- > 0;) {
    const double y = x[d] - shift;
    sum += y;
    squares += y * y;
    n += 1;
    if (d > last) continue;
    const double error = std::max(0.0, squares - sum * sum / n) / (n * n);
    if (error <= least) {  // of equals the earliest
      least = error;
      best = d;
    }
  }
  return best == last ? -1 : static_cast<int>(best);
}

double SteadyOnset::from(double least) const {
  for (const double onset : {s, F, P}) {
    if (onset > least) least = onset;
  }
  return least;
}

SteadyOnset steady_onset(const TestRecord& test) {
  const LawDirection direction = law_direction(test.path.segments.front().direction);
  std::vector<double> eps_dev, s, F, P;
  for (const Observation& row : test.rows) {
    if (!is_jammed(row)) continue;
    const LawState<double> state = measured_state(test, row);
    eps_dev.push_back(deviatoric_norm(row.strain.tensor - test.rows.front().strain.tensor));
    s.push_back(state.sigma.dot(direction.N) / state.P);
    F.push_back(state.F.dot(direction.N));
    P.push_back(state.P);
  }
  const auto onset = [&](const std::vector<double>& x) {
    const bool told = std::ranges::none_of(x, [](double value) { return std::isnan(value); });
    const int row = told ? steady_row(x) : -1;
    return row < 0 ? std::numeric_limits<double>::quiet_NaN() : eps_dev[static_cast<std::size_t>(row)];
  };
  return {onset(s), onset(F), onset(P)};
}

}  // namespace grainlaw::fit
