#include "chain/planning/plan_pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "fit/data/options.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kRounding = 1e-9;

double observed(const Observation& row, const std::string& quantity) {
  return quantity == "P_star" ? row.P_star : quantity == "s_par" ? row.s_par : row.F_par;
}

/// Values of something by test, the seed aside, and by packing.
using Table = std::map<std::string, std::map<std::uint64_t, double>>;

std::string path_name(const TestRecord& test) {
  return test.name.substr(0, test.name.rfind(fmt::format("-s{}", test.packing.seed)));
}

double mean_of(const std::map<std::uint64_t, double>& values) {
  double sum = 0;
  for (const auto& [seed, value] : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double variance_of_mean(const std::map<std::uint64_t, double>& values) {
  const double mean = mean_of(values), n = static_cast<double>(values.size());
  double squares = 0;
  for (const auto& [seed, value] : values) squares += (value - mean) * (value - mean);
  return squares / (n - 1) / n;
}

template <class Counts>
double mean_over_rows(const TestRecord& test, const std::string& quantity, const Counts& counts) {
  double sum = 0, n = 0;
  for (const Observation& row : test.rows) {
    const double value = observed(row, quantity);
    if (!counts(row) || !std::isfinite(value)) continue;
    sum += value;
    ++n;
  }
  if (n == 0) throw Error(fmt::format("{}: no row of it says anything of {}", test.name, quantity));
  return sum / n;
}

/// Sum over the tests of their means, by packing.
std::map<std::uint64_t, double> sums_of(const std::vector<TestRecord>& tests, const std::string& quantity) {
  const double nu_min = fit::CalibrationOptions{}.iso_nu_min;
  std::map<std::uint64_t, double> sums;
  for (const TestRecord& test : tests) {
    const bool isotropic = quantity == "P_star" && is_isotropic_unloading(test);
    if (!isotropic && !is_pure_shear(test)) continue;
    sums[test.packing.seed] += mean_over_rows(test, quantity, [&](const Observation& row) { return row.nu >= nu_min; });
  }
  return sums;
}

}  // namespace

std::vector<SteadyScatter> steady_scatter(const std::vector<TestRecord>& tests, const std::string& quantity,
                                          const std::vector<double>& strains) {
  const double from = fit::CalibrationOptions{}.steady_from;
  std::vector<SteadyScatter> all;
  for (const double strain : strains) {
    Table relative;
    for (const TestRecord& test : tests) {
      if (!is_pure_shear(test)) continue;
      relative[path_name(test)][test.packing.seed] = mean_over_rows(test, quantity, [&](const Observation& row) {
        return row.shear_path >= from - kRounding && row.shear_path <= strain + kRounding;
      });
    }
    std::map<std::uint64_t, double> of_packing;
    for (auto& [path, values] : relative) {
      const double mean = mean_of(values);
      for (auto& [seed, value] : values) {
        value = value / mean - 1;
        of_packing[seed] += value / static_cast<double>(relative.size());
      }
    }
    const double n = static_cast<double>(of_packing.size()), D = static_cast<double>(relative.size());
    if (n < 2 || D < 2) throw Error("plan: a pilot needs two packings and two tests of shear at constant volume");
    double of_packings = 0, within = 0;
    for (const auto& [seed, mean] : of_packing) of_packings += mean * mean / (n - 1);
    for (const auto& [path, values] : relative) {
      for (const auto& [seed, value] : values) within += std::pow(value - of_packing[seed], 2) / (n - 1) / (D - 1);
    }
    all.push_back({strain, std::max(0.0, of_packings - within / D), within});
  }
  return all;
}

Difference difference_of(const std::vector<TestRecord>& coarse, const std::vector<TestRecord>& fine,
                         const std::string& quantity, bool paired) {
  const auto ours = sums_of(coarse, quantity), theirs = sums_of(fine, quantity);
  const double reference = mean_of(theirs);
  if (!paired)
    return {mean_of(ours) / reference - 1,
            std::sqrt(variance_of_mean(ours) + variance_of_mean(theirs)) / std::abs(reference)};
  std::map<std::uint64_t, double> differences;
  for (const auto& [seed, sum] : theirs) differences[seed] = (ours.at(seed) - sum) / reference;
  return {mean_of(differences), std::sqrt(variance_of_mean(differences))};
}

double energy_residual(const std::vector<TestRecord>& tests) {
  double sum = 0, n = 0;
  for (const TestRecord& test : tests) {
    if (!is_pure_shear(test)) continue;
    double largest = 0;
    for (const Observation& row : test.rows) {
      if (std::isfinite(row.energy_residual)) largest = std::max(largest, std::abs(row.energy_residual));
    }
    sum += largest;
    ++n;
  }
  return n > 0 ? sum / n : 0;
}

CostRates cost_rates(const Dataset& dataset, const Work& work, double fit_seconds, int threads) {
  double seconds = 0, steps = 0, prepared = 0;
  std::set<std::string> preparations;
  for (const DatasetTest& test : dataset.tests) {
    if (test.cost.steps == 0) {  // a branch of the preparation, whose seconds these are
      if (preparations.insert(test.run).second) prepared += test.cost.seconds;
      continue;
    }
    seconds += test.cost.seconds;
    steps += static_cast<double>(test.cost.steps) * static_cast<double>(test.record.packing.particles);
  }
  const double packings = static_cast<double>(dataset.seeds.size());
  CostRates rates;
  rates.particle_step = steps > 0 ? seconds / steps / threads : 0;
  const double driven = packings * work.preparation * rates.particle_step * threads;
  rates.relaxed = std::max(0.0, prepared - driven) / (packings * work.relaxed) / threads;
  rates.fitted_test = fit_seconds / (packings * work.fitted_tests);
  return rates;
}

}  // namespace grainlaw::chain
