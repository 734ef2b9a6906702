#include "fit/data/outliers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "fit/data/shear_rows.hpp"
#include "model/evolution.hpp"

namespace grainlaw::fit {
namespace {

constexpr std::size_t kReach = 2;  // rows to either side
constexpr double kWhite = 1.2105;  // 1.4826/sqrt(1.5): white noise over the median magnitude of its second differences
constexpr double kStandsOut = 8;   // times the scatter
constexpr double kMaterial = 5;    // times the scale; rattlers are counted, and jump by more than their scatter
constexpr double kNoScatter = 1e-9;  // relative, of series without any scatter
constexpr std::size_t kFewest = 8;   // rows from which a scatter can be told
constexpr std::size_t kNamed = 8;    // rows named in a warning
constexpr double kApart = 0.04;      // of volume fraction, a choice

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Steps from row to row around row i, those from and to it left out: their median, and how far they are from it.
struct Trend {
  double step = 0, scatter = 0;
};

Trend trend_at(const std::vector<double>& x, std::size_t i) {
  std::vector<double> steps;
  const std::size_t from = i > 2 * kReach ? i - 2 * kReach : 0, to = std::min(i + 2 * kReach, x.size() - 1);
  for (std::size_t k = from; k < to; ++k) {
    if (k != i && k + 1 != i) steps.push_back(x[k + 1] - x[k]);
  }
  if (steps.empty()) return {};
  Trend trend{median(steps), 0};
  for (double& step : steps) step = std::abs(step - trend.step);
  trend.scatter = median(std::move(steps));
  return trend;
}

struct Column {
  const char* name;
  double scale;
  std::function<double(const Observation&)> value;
};

std::vector<Column> columns_of(const TestRecord& test, const CalibrationOptions& options) {
  std::vector<Column> columns{
      {"P_star", options.pressure_scale, [](const Observation& o) { return std::log(o.P_star); }},
      {"C_star", options.pressure_scale, [](const Observation& o) { return std::log(o.C_star); }},
      {"rattler_fraction", options.pressure_scale, [](const Observation& o) { return o.rattler_fraction; }}};
  const Deviator<double> N = shear_direction(resolve(test.path));
  if (N.isZero()) return columns;
  columns.push_back({"s_par", options.stress_scale, [N](const Observation& o) {
                       return deviator<double>(o.stress.tensor).dot(N) / (o.stress.tensor.trace() / 3);
                     }});
  columns.push_back(
      {"F_par", options.fabric_scale, [N](const Observation& o) { return deviator<double>(o.fabric.tensor).dot(N); }});
  return columns;
}

/// Numbers of the rows of one segment that the fit reads.
std::vector<std::size_t> rows_of(const TestRecord& test, int segment, const CalibrationOptions& options) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    const Observation& row = test.rows[i];
    if (row.segment != segment || !is_jammed(row)) continue;
    if (is_isotropic_unloading(test) && row.nu < options.iso_nu_min) continue;
    rows.push_back(i);
  }
  return rows;
}

}  // namespace

std::vector<std::size_t> outliers_of(const std::vector<double>& x, double least) {
  std::vector<std::size_t> found;
  if (x.size() < kFewest) return found;
  std::vector<double> z(x.size(), 0), scatter(x.size(), 0), bend;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const Trend trend = trend_at(x, i);
    const std::size_t behind = x.size() - 1 - i;  // the last row has neighbours on one side
    const std::size_t reach = behind == 0 ? kReach : std::min({kReach, i, behind});
    std::vector<double> off;
    for (std::size_t k = i - reach; k <= i + std::min(reach, behind); ++k) {
      off.push_back(x[i] - x[k] + trend.step * (static_cast<double>(k) - static_cast<double>(i)));
    }
    z[i] = std::abs(median(std::move(off)));
    scatter[i] = trend.scatter;
    if (behind > 0) bend.push_back(std::abs(x[i] - (x[i - 1] + x[i + 1]) / 2));
  }
  const double sigma = kWhite * median(std::move(bend));
  // that one side has company is not known of the last: there may be a jump like any other of the series
  for (std::size_t i = 1; i + 1 < x.size(); ++i) scatter.back() = std::max(scatter.back(), std::abs(x[i] - x[i - 1]));
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double usual = std::max({sigma, scatter[i], kNoScatter * std::abs(x[i])});
    if (z[i] > kStandsOut * usual && z[i] > least) found.push_back(i);
  }
  return found;
}

std::vector<std::string> packing_warnings(const DataSet& data) {
  if (data.isotropic.empty()) return {};
  double nu = 1;
  for (const TestRecord* test : data.isotropic) nu = std::min(nu, test->rows.front().nu);
  const auto at_nu = [nu](const TestRecord* test) -> const Observation& {
    return *std::ranges::min_element(test->rows, {}, [nu](const Observation& row) { return std::abs(row.nu - nu); });
  };
  const auto by_P_star = [&](const TestRecord* a, const TestRecord* b) { return at_nu(a).P_star < at_nu(b).P_star; };
  const auto [weak, strong] = std::ranges::minmax_element(data.isotropic, by_P_star);
  const Observation& weakest = at_nu(*weak);
  double denser = 0;  // to the farthest row in which the strongest still bears more
  for (const Observation& row : (*strong)->rows) {
    if (row.P_star > weakest.P_star) denser = std::max(denser, weakest.nu - row.nu);
  }
  if (!(denser > kApart && weakest.P_star > 0)) return {};
  return {fmt::format(
      "test {} has at nu = {:.3g} {:.3g} times the P* of {}, as if denser by {:.2g}: are mean_radius and stiffness of "
      "both packings right?",
      (*strong)->name, nu, at_nu(*strong).P_star / weakest.P_star, (*weak)->name, denser)};
}

std::vector<std::string> outlier_warnings(const DataSet& data, const CalibrationOptions& options) {
  std::vector<std::string> warnings;
  for (const TestRecord* test : data.all_used()) {
    for (const Column& column : columns_of(*test, options)) {
      std::vector<std::size_t> found;
      for (int segment = 0; segment < static_cast<int>(test->path.segments.size()); ++segment) {
        const std::vector<std::size_t> rows = rows_of(*test, segment, options);
        std::vector<double> x;
        for (const std::size_t i : rows) x.push_back(column.value(test->rows[i]));
        if (std::ranges::any_of(x, [](double value) { return std::isnan(value); }))
          continue;  // the test does not tell it
        for (const std::size_t i : outliers_of(x, kMaterial * column.scale))
          found.push_back(rows[i] + 1);  // as in a file
      }
      if (found.empty()) continue;
      const std::size_t named = std::min(found.size(), kNamed);
      warnings.push_back(
          fmt::format("test {}: {} of {} rows of {} stand out from their neighbours (row{} {}{}) and pull the fit; "
                      "look at them, remove "
                      "them or repeat the test",
                      test->name, found.size(), test->rows.size(), column.name, found.size() == 1 ? "" : "s",
                      fmt::join(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                      named < found.size() ? " ..." : ""));
    }
  }
  return warnings;
}

}  // namespace grainlaw::fit
