#include "app/settings_study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace grainlaw::app {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Whether `other` shows every quantity that `one` shows; an error over fewer of them would be no better one.
bool shows_as_much(const SettingResult& other, const SettingResult& one) {
  for (std::size_t q = 0; q < one.errors.size(); ++q) {
    if (one.errors[q].in_error && std::isfinite(one.errors[q].error) && !std::isfinite(other.errors[q].error))
      return false;
  }
  return true;
}

void find_dominated(std::vector<SettingResult>& results, std::size_t first) {
  for (std::size_t i = first; i < results.size(); ++i) {
    SettingResult& one = results[i];
    for (std::size_t j = first; j < results.size(); ++j) {
      const SettingResult& other = results[j];
      if (other.outcome.cost.particle_steps < one.outcome.cost.particle_steps && other.reached <= one.reached &&
          shows_as_much(other, one))
        one.dominated_by.push_back(other.outcome.name);
    }
  }
}

}  // namespace

Cost cost_of(const Dataset& dataset) {
  Cost cost;
  std::set<std::string> counted;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role != Role::calibration) continue;
    if (!test.run.empty() && !counted.insert(test.run).second) continue;
    cost.particle_steps += static_cast<double>(test.cost.steps) * static_cast<double>(test.record.packing.particles);
    cost.seconds += test.cost.seconds;
  }
  return cost;
}

std::vector<std::uint64_t> packings_of(const Dataset& dataset) {
  std::set<std::uint64_t> seeds;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration) seeds.insert(test.record.packing.seed);
  }
  return {seeds.begin(), seeds.end()};
}

SettingResult compare_setting(const SettingOutcome& setting, const SettingOutcome& reference, Packings packings) {
  SettingResult result{setting, {}, kMissing, kMissing, kMissing, kMissing, {}};
  double errors = 0, floors = 0, samplings = 0;
  int counted = 0;
  for (const StudyQuantity& theirs : reference.quantities) {
    const auto found = std::find_if(setting.quantities.begin(), setting.quantities.end(),
                                    [&](const StudyQuantity& q) { return q.name == theirs.name; });
    const QuantityError e =
        compare(found == setting.quantities.end() ? StudyQuantity{} : *found, setting.seeds, theirs, reference.seeds);
    result.errors.push_back(e);
    if (!e.in_error || !std::isfinite(e.error)) continue;
    errors += e.error * e.error;
    floors += e.standard_error * e.standard_error;
    samplings += e.sampling * e.sampling;
    ++counted;
  }
  if (counted == 0) return result;
  result.error = std::sqrt(errors / counted);
  result.floor = std::sqrt(floors / counted);
  result.sampling = std::sqrt(samplings / counted);
  const double noise = packings == Packings::given ? floors : samplings;
  result.reached = std::sqrt((std::max(errors - floors, 0.0) + noise) / counted);
  return result;
}

SettingsStudy study_of(const std::string& kind, const std::string& error, Packings packings, const Json& base,
                       const std::vector<SettingOutcome>& outcomes, std::size_t judged) {
  SettingsStudy study{kind, error, packings, base, judged, {}};
  for (const SettingOutcome& outcome : outcomes)
    study.results.push_back(compare_setting(outcome, outcomes.front(), packings));
  find_dominated(study.results, judged);
  return study;
}

}  // namespace grainlaw::app
