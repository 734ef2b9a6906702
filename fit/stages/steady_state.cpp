#include "fit/stages/steady_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/data/density_series.hpp"
#include "fit/stages/measured_state.hpp"

namespace grainlaw::fit {
namespace {

constexpr std::size_t kFewestRows = 8;

}  // namespace

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
    const int row = steady_row(x);
    return row < 0 ? std::numeric_limits<double>::quiet_NaN() : eps_dev[static_cast<std::size_t>(row)];
  };
  return {onset(s), onset(F), onset(P)};
}

}  // namespace grainlaw::fit
