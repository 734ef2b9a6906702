#include "dem/runs/new_packings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dem/runs/engine_path.hpp"
#include "dem/runs/preparation_json.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

std::vector<std::uint64_t> new_seeds(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& wished,
                                     const std::string& name) {
  std::vector<std::uint64_t> seeds = wished.empty() ? path.seeds : wished;
  if (seeds.empty()) {
    const std::uint64_t largest = *std::max_element(spec.seeds.begin(), spec.seeds.end());
    for (std::size_t i = 1; i <= spec.seeds.size(); ++i) seeds.push_back(largest + i);
  }
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (std::find(spec.seeds.begin(), spec.seeds.end(), seeds[i]) != spec.seeds.end()) {
      throw InvalidInput(
          fmt::format("{}: seeds: {} was used for the calibration; a prediction is tested on packings it has not seen, "
                      "give another",
                      name, seeds[i]));
    }
    if (std::find(seeds.begin(), seeds.begin() + static_cast<std::ptrdiff_t>(i), seeds[i]) !=
        seeds.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InvalidInput(fmt::format("{}: seeds: {} is given twice", name, seeds[i]));
    }
  }
  return seeds;
}

std::vector<PlannedTest> plan(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& seeds,
                              const std::string& name) {
  PreparationOptions preparation = spec.preparation;
  // only what predictions start from: paths that name the spec's `keep` share their packings
  preparation.keep_loading.clear();
  preparation.keep_unloading = spec.keep;
  auto& kept = path.path.branch == Branch::loading ? preparation.keep_loading : preparation.keep_unloading;
  if (std::find(kept.begin(), kept.end(), path.path.nu) == kept.end()) kept.push_back(path.path.nu);
  std::sort(kept.begin(), kept.end());
  complete_preparation(preparation, name);
  const double steps = expected_steps(preparation, engine_path(path.path, name));
  if (!(steps <= kMaxSteps))
    throw InvalidInput(
        fmt::format("{}: segments: take {:.3g} steps, more than {:.0g}; shorten the path", name, steps, kMaxSteps));

  TestRequest request;
  request.branch = path.path.branch;
  request.segments = path.path.segments;
  request.name = default_name(request);
  std::vector<PlannedTest> tests;
  for (const std::uint64_t seed : seeds) {
    preparation.packing.seed = seed;
    tests.push_back({record_name(request, path.path.nu, seed), Role::validation, path.path, preparation,
                     path.rows.value_or(preparation.rows), false});
  }
  return tests;
}

}  // namespace grainlaw::dem
