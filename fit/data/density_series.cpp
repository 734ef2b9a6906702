#include "fit/data/density_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/data/shear_rows.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kNone = Observation::undefined;

void require(const TestRecord& test, std::size_t row, double value, const char* column) {
  if (!std::isfinite(value)) {
    throw InvalidInput(
        fmt::format("test {}: row {}, column {} is {} in a jammed state; repeat the test or remove the row", test.name,
                    row + 1, column, value));
  }
}

DensityPoint point_of(const TestRecord& test, std::size_t number) {
  const Observation& row = test.rows[number];
  if (!counts_contacts(test)) return {row.nu, kNone, kNone, row.P_star, row.fabric.tensor.trace(), row.mean_overlap};
  require(test, number, row.C_star, "C_star");
  require(test, number, row.rattler_fraction, "rattler_fraction");
  return {row.nu, row.C_star, row.rattler_fraction, row.P_star, row.fabric.tensor.trace(), row.mean_overlap};
}

DensityPoint mean(const std::vector<DensityPoint>& points) {
  DensityPoint m;
  for (const DensityPoint& p : points) {
    m.nu += p.nu;
    m.C_star += p.C_star;
    m.rattler_fraction += p.rattler_fraction;
    m.P_star += p.P_star;
    m.F_v += p.F_v;
    m.mean_overlap += p.mean_overlap;
  }
  const double n = static_cast<double>(points.size());
  return {m.nu / n, m.C_star / n, m.rattler_fraction / n, m.P_star / n, m.F_v / n, m.mean_overlap / n};
}

}  // namespace

std::vector<DensitySeries> unloading_series(const std::vector<const TestRecord*>& tests, const DataSet& data,
                                            const CalibrationOptions& options) {
  std::vector<DensitySeries> all;
  for (const TestRecord* test : tests) {
    DensitySeries series{test->name, packing_of(data, *test), 0, {}};
    for (std::size_t i = 0; i < test->rows.size(); ++i) {
      const Observation& row = test->rows[i];
      const PathSegment& segment = test->path.segments.at(static_cast<std::size_t>(row.segment));
      if (segment.direction.tensor.trace() > 0 && row.nu >= options.iso_nu_min && is_jammed(row))
        series.points.push_back(point_of(*test, i));
      else
        ++series.excluded;
    }
    if (!series.points.empty()) all.push_back(series);
  }
  return all;
}

std::vector<DensitySeries> isotropic_series(const DataSet& data, const CalibrationOptions& options) {
  const std::vector<DensitySeries> all = unloading_series(data.isotropic, data, options);
  std::size_t points = 0;
  for (const DensitySeries& series : all) points += series.points.size();
  if (points < 4) {
    throw InvalidInput(
        fmt::format("test {}: the ISO unloading tests have {} jammed rows with nu >= {}; unload from a higher "
                    "volume fraction or record more rows",
                    data.isotropic.front()->name, points, options.iso_nu_min));
  }
  return all;
}

std::vector<DensitySeries> steady_series(const DataSet& data, Mode mode, const CalibrationOptions& options) {
  std::vector<DensitySeries> all;
  for (const TestRecord* test : data.pure_shear) {
    const PathSegment& shear = test->path.segments.front();
    if (mode == Mode::D2 ? !is_like_D2(law_direction(shear.direction).lode) : shear.mode != mode) continue;
    DensitySeries series{test->name, packing_of(data, *test), 0, {}};
    std::vector<DensityPoint> steady;
    const double from = steady_onset(*test).from(options.steady_from);
    for (std::size_t i = 0; i < test->rows.size(); ++i) {
      const Observation& row = test->rows[i];
      if (deviatoric_norm(row.strain.tensor - test->rows.front().strain.tensor) >= from - 1e-9 && is_jammed(row))
        steady.push_back(point_of(*test, i));
      else
        ++series.excluded;
    }
    if (steady.empty()) continue;
    series.points.push_back(mean(steady));
    all.push_back(series);
  }
  return all;
}

std::vector<DensitySeries> with_contacts(const std::vector<DensitySeries>& series) {
  std::vector<DensitySeries> counted;
  for (const DensitySeries& s : series) {
    if (!std::isnan(s.points.front().C())) counted.push_back(s);
  }
  return counted;
}

double least_nu(const std::vector<DensitySeries>& series) {
  double least = 1;
  for (const DensitySeries& s : series) {
    for (const DensityPoint& p : s.points) least = std::min(least, p.nu);
  }
  return least;
}

int distinct_densities(std::vector<double> nu) {
  std::sort(nu.begin(), nu.end());
  int count = 0;
  double last = -1;
  for (double v : nu) {
    if (v - last > 0.002) {
      ++count;
      last = v;
    }
  }
  return count;
}

}  // namespace grainlaw::fit
