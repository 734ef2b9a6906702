#pragma once
// Errors of an integration over the tolerance that it was asked for, and what each cost.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace grainlaw::testing {

class ToleranceStudy {
 public:
  /// Of several runs at one tolerance the largest error counts, and the largest number of right-hand sides.
  void add(double tolerance, double error, long rhs_evaluations) {
    Entry& entry = entries_[tolerance];
    entry.error = std::max(entry.error, error);
    entry.rhs_evaluations = std::max(entry.rhs_evaluations, rhs_evaluations);
  }

  double largest_over_tolerance() const {
    double largest = 0;
    for (const auto& [tolerance, entry] : entries_) largest = std::max(largest, entry.error / tolerance);
    return largest;
  }

  /// Of log error over log tolerance, by least squares.
  double slope() const {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [tolerance, entry] : entries_) {
      const double lx = std::log10(tolerance), ly = std::log10(entry.error);
      n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
    }
    return (n * xy - x * y) / (n * xx - x * x);
  }

  static std::vector<std::string> header() {
    return {"method", "rtol", "largest error", "error/rtol", "right-hand sides", "slope from the row above"};
  }

  /// One row for each tolerance, the loosest first.
  std::vector<std::vector<std::string>> rows(const std::string& method) const {
    std::vector<std::vector<std::string>> rows;
    double tolerance_before = 0, error_before = 0;
    for (const auto& [tolerance, entry] : entries_) {
      const double slope = std::log(entry.error / error_before) / std::log(tolerance / tolerance_before);
      rows.push_back({method, fmt::format("{:.0e}", tolerance), fmt::format("{:.2e}", entry.error),
                      fmt::format("{:.2f}", entry.error / tolerance), fmt::format("{}", entry.rhs_evaluations),
                      rows.empty() ? "-" : fmt::format("{:.2f}", slope)});
      tolerance_before = tolerance;
      error_before = entry.error;
    }
    return rows;
  }

 private:
  struct Entry {
    double error = 0;
    long rhs_evaluations = 0;
  };
  std::map<double, Entry, std::greater<>> entries_;
};

}  // namespace grainlaw::testing
