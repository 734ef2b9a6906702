#include "fit/data/packing_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainlaw::fit {
namespace {

bool same_path(const TestRecord& a, const TestRecord& b) {
  return a.rows.size() == b.rows.size() && a.path.branch == b.path.branch &&
         std::abs(a.path.nu - b.path.nu) < kSameDensity &&
         std::ranges::equal(a.path.segments, b.path.segments, [](const PathSegment& p, const PathSegment& q) {
           return p.direction.tensor == q.direction.tensor && p.extent_kind == q.extent_kind && p.extent == q.extent;
         });
}

struct Mean {
  double sum = 0;
  int count = 0;

  void add(double value) {
    if (!std::isfinite(value)) return;
    sum += value;
    ++count;
  }
  double value() const { return sum / count; }  // NaN of nothing
};

using Quantity = double (*)(const Observation& row, double B);
constexpr std::array<Quantity, 3> kQuantities{[](const Observation& row, double B) { return row.P_star / B; },
                                              [](const Observation& row, double) { return row.s_par; },
                                              [](const Observation& row, double) { return row.F_par; }};

/// Mean over the rows of the variance between `runs` of one path.
double variance(const std::vector<const TestRecord*>& runs, Quantity quantity, const LawParameters<double>& law,
                double nu_min) {
  Mean rows;
  for (std::size_t i = 0; i < runs.front()->rows.size(); ++i) {
    const double nu = runs.front()->rows[i].nu, B = law.isotropic.B_star(nu);
    if (!(nu >= nu_min && B > 0)) continue;
    Mean mean, squares;
    for (const TestRecord* run : runs) mean.add(quantity(run->rows[i], B));
    if (mean.count < static_cast<int>(runs.size())) continue;
    for (const TestRecord* run : runs) squares.add(std::pow(quantity(run->rows[i], B) - mean.value(), 2));
    rows.add(squares.sum / (mean.count - 1));
  }
  return rows.value();
}

}  // namespace

PackingScatter packing_scatter(const DataSet& data, const LawParameters<double>& law, double nu_min) {
  std::vector<std::vector<const TestRecord*>> paths;
  for (const TestRecord* test : data.all_used()) {
    const auto path = std::ranges::find_if(paths, [&](const auto& runs) { return same_path(*runs.front(), *test); });
    if (path == paths.end())
      paths.push_back({test});
    else
      path->push_back(test);
  }
  PackingScatter scatter;
  std::array<Mean, kQuantities.size()> mean;
  for (const auto& runs : paths) {
    scatter.packings = std::max(scatter.packings, static_cast<int>(runs.size()));
    if (runs.size() < 2) continue;
    scatter.degrees_of_freedom += static_cast<int>(runs.size()) - 1;
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q].add(variance(runs, kQuantities[q], law, nu_min));
  }
  scatter.compression = std::sqrt(mean[0].value());
  scatter.s_par = std::sqrt(mean[1].value());
  scatter.F_par = std::sqrt(mean[2].value());
  return scatter;
}

}  // namespace grainlaw::fit
