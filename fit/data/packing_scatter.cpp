#include "fit/data/packing_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainlaw::fit {
namespace {

using Quantity = double (*)(const Observation& row, const LawParameters<double>& law);
/// P* less the law's: runs that start apart differ by no more than their packings do.
constexpr std::array<Quantity, 3> kQuantities{
    [](const Observation& row, const LawParameters<double>& law) {
      return (row.P_star - law.isotropic.P_star(row.nu)) / law.isotropic.B_star(row.nu);
    },
    [](const Observation& row, const LawParameters<double>&) { return row.s_par; },
    [](const Observation& row, const LawParameters<double>&) { return row.F_par; }};

/// Of one path, no two on the same packing.
using Runs = std::vector<const TestRecord*>;

std::vector<Runs> runs_of_paths(const DataSet& data) {
  std::vector<Runs> all;
  for (const TestRecord* test : data.all_used()) {
    const auto known =
        std::ranges::find_if(all, [&](const Runs& runs) { return same_path(runs.front()->path, test->path); });
    const auto on_its_packing = [&](const TestRecord* other) { return other->packing.seed == test->packing.seed; };
    if (known == all.end())
      all.push_back({test});
    else if (std::ranges::none_of(*known, on_its_packing))
      known->push_back(test);
  }
  return all;
}

/// The i-th rows of `runs`, if they are one place of the path, jammed and at nu >= `nu_min`; else none.
std::vector<const Observation*> rows_at(const Runs& runs, std::size_t i, const LawParameters<double>& law,
                                        double nu_min) {
  std::vector<const Observation*> rows;
  for (const TestRecord* test : runs) {
    if (i >= test->rows.size()) return {};
    const Observation& row = test->rows[i];
    const double off = rows.empty() ? 0 : (row.strain.tensor - rows.front()->strain.tensor).norm();
    if (!(row.nu >= nu_min && law.isotropic.B_star(row.nu) > 0 && off <= kSameDensity)) return {};
    rows.push_back(&row);
  }
  return rows;
}

/// Adds to `gram`, packings x packings, products of what the packings are off the mean of a path's runs: its trace is the mean
/// over the rows of the variance between them. False without rows.
bool add_path(const Runs& runs, const std::vector<Eigen::Index>& packing, Quantity quantity,
              const LawParameters<double>& law, double nu_min, Eigen::MatrixXd& gram) {
  const auto n = static_cast<Eigen::Index>(runs.size());
  Eigen::MatrixXd of_path = Eigen::MatrixXd::Zero(n, n);
  int count = 0;
  for (std::size_t i = 0; i < runs.front()->rows.size(); ++i) {
    const std::vector<const Observation*> rows = rows_at(runs, i, law, nu_min);
    if (rows.empty()) continue;
    Eigen::VectorXd value(n);
    for (Eigen::Index g = 0; g < n; ++g) value(g) = quantity(*rows[static_cast<std::size_t>(g)], law);
    if (!value.allFinite()) continue;
    value.array() -= value.mean();
    of_path += value * value.transpose();
    ++count;
  }
  if (count == 0) return false;
  gram(packing, packing) += of_path / (count * static_cast<double>(n - 1));
  return true;
}

/// Of trace(gram) as a variance, by what the packings show of how alike their paths are; docs/theory/fit.md.
double degrees_of_freedom(const Eigen::MatrixXd& gram, double least, double most) {
  constexpr double kOfTwo = 0.25;  // of the runs; two packings show nothing of it, the paper's five 24 of 88
  const double trace = gram.trace(), n = static_cast<double>(gram.rows() - 1);
  if (n < 2) return std::max(least, kOfTwo * most);
  const double square = n * n / ((n + 2) * (n - 1)) * (gram.squaredNorm() - trace * trace / n);
  return square > 0 ? std::clamp(n * (trace * trace - 2 / n * square) / square, least, most) : most;
}

}  // namespace

PackingScatter packing_scatter(const DataSet& data, const LawParameters<double>& law, double nu_min) {
  std::vector<Runs> paths = runs_of_paths(data);
  PackingScatter scatter;
  for (const Runs& runs : paths) scatter.packings = std::max(scatter.packings, static_cast<int>(runs.size()));
  std::erase_if(paths, [](const Runs& runs) { return runs.size() < 2; });
  std::vector<std::uint64_t> packings;  // that share a path with another
  double beyond_the_first = 0;
  for (const Runs& runs : paths) {
    for (const TestRecord* test : runs) packings.push_back(test->packing.seed);
    beyond_the_first += static_cast<double>(runs.size() - 1);
  }
  std::ranges::sort(packings);
  packings.erase(std::unique(packings.begin(), packings.end()), packings.end());
  const auto G = static_cast<Eigen::Index>(packings.size());
  scatter.degrees_of_freedom = beyond_the_first;
  for (const auto& [quantity, deviation] : {std::pair{kQuantities[0], &scatter.compression},
                                            {kQuantities[1], &scatter.s_par},
                                            {kQuantities[2], &scatter.F_par}}) {
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(G, G);
    int count = 0;
    for (const Runs& runs : paths) {
      std::vector<Eigen::Index> index;
      for (const TestRecord* test : runs)
        index.push_back(std::ranges::lower_bound(packings, test->packing.seed) - packings.begin());
      count += add_path(runs, index, quantity, law, nu_min, gram) ? 1 : 0;
    }
    if (count == 0) continue;
    gram /= count;
    *deviation = std::sqrt(gram.trace());
    scatter.degrees_of_freedom =
        std::min(scatter.degrees_of_freedom, degrees_of_freedom(gram, scatter.packings - 1, beyond_the_first));
  }
  return scatter;
}

}  // namespace grainlaw::fit
