#include "chain/studies/reference_by_packings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "chain/studies/calibrated_setting.hpp"

namespace grainlaw::chain {
namespace {

bool same_packing(const PackingInfo& a, const PackingInfo& b) {
  return a.seed == b.seed && a.particles == b.particles && a.size_width == b.size_width &&
         a.mean_radius == b.mean_radius && a.stiffness == b.stiffness;
}

bool contains_packing(const Dataset& dataset, const PackingInfo& packing) {
  return std::any_of(dataset.tests.begin(), dataset.tests.end(), [&](const DatasetTest& test) {
    return test.record.role == Role::calibration && same_packing(test.record.packing, packing);
  });
}

}  // namespace

ReferenceByPackings::ReferenceByPackings(Dataset reference, SettingOutcome whole, fit::CalibrationOptions options,
                                         std::vector<double> densities, std::optional<Path> path)
    : reference_(std::move(reference)),
      whole_(std::move(whole)),
      options_(std::move(options)),
      densities_(std::move(densities)),
      path_(std::move(path)) {}

std::vector<StudyQuantity> ReferenceByPackings::quantities(const Dataset& dataset, const Execution& execution) {
  const std::vector<std::uint64_t> seeds = packings_of(dataset);
  if (seeds == whole_.seeds) return {};
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration && !contains_packing(reference_, test.record.packing)) return {};
  }
  if (!found_.contains(seeds)) {
    Dataset part = reference_;
    std::erase_if(part.tests, [&](const DatasetTest& test) {
      return !std::binary_search(seeds.begin(), seeds.end(), test.record.packing.seed);
    });
    const std::string name = fmt::format("{} by packings {}", whole_.name, fmt::join(seeds, ", "));
    found_.emplace(seeds, calibrated_setting(name, {}, part, options_, densities_, path_, execution));
  }
  const SettingOutcome& found = found_.at(seeds);
  return found.model == whole_.model ? found.quantities : std::vector<StudyQuantity>{};
}

}  // namespace grainlaw::chain
