#pragma once
// How often intervals contain the truth, parameter by parameter, and how far the values lie from it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "fit/calibrate.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/fit_stages.hpp"
#include "tests/support/table.hpp"

namespace grainlaw::testing {

class Coverage {
 public:
  void add(const fit::NamedEstimate& e, const LawParameters<double>& truth) {
    Count& count = counts_[e.name];
    ++count.sets;
    const double half = e.estimate.half_width();
    if (!std::isfinite(half)) return;
    ++count.intervals;
    const double off = e.estimate.value - *fields(truth)[parameter_index(e.name)];
    count.inside += std::abs(off) <= half;
    count.off += off;
    count.square += off * off;
  }
  void add(const std::vector<fit::NamedEstimate>& estimates, const LawParameters<double>& truth) {
    for (const fit::NamedEstimate& e : estimates) add(e, truth);
  }

  struct Count {
    int sets = 0, intervals = 0, inside = 0;
    double off = 0, square = 0;  ///< value - truth and its square, sums over the intervals
    double coverage() const { return static_cast<double>(inside) / sets; }  ///< a set without an interval is a miss
    /// Mean of value - truth over the standard deviation of the values.
    double distance() const {
      const double mean = off / intervals;
      return mean / std::sqrt((square / intervals - mean * mean) * intervals / (intervals - 1));
    }
  };
  const std::map<std::string, Count>& counts() const { return counts_; }

 private:
  std::map<std::string, Count> counts_;
};

/// A figure for the parameter that is covered least and for the one that is covered most.
inline void expect_coverage(const std::string& name, const Coverage& coverage, double least, double most) {
  double lowest = 1, highest = 0;
  for (const auto& [parameter, count] : coverage.counts()) {
    EXPECT_GE(count.coverage(), least) << name << " " << parameter << ", intervals " << count.intervals;
    EXPECT_LE(count.coverage(), most) << name << " " << parameter;
    lowest = std::min(lowest, count.coverage());
    highest = std::max(highest, count.coverage());
  }
  expect_figure(name + ".not_covered_at_most", 1 - lowest, 1 - least);
  expect_figure(name + ".covered_at_most", highest, most);
}

/// One row for each parameter.
inline void coverage_table(const std::string& name, const Coverage& coverage) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [parameter, count] : coverage.counts())
    rows.push_back({parameter, fmt::format("{}", count.intervals), fmt::format("{:.3f}", count.coverage()),
                    fmt::format("{:+.2f}", count.distance())});
  print_table(name, {"parameter", "sets with an interval", "coverage", "mean distance in standard deviations"}, rows);
}

}  // namespace grainlaw::testing
