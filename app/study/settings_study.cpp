#include "app/study/settings_study.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "dem/element_test.hpp"

namespace grainlaw::app {
namespace {

// Keys of SPEC that say how to compute, and nothing of what is computed.
const std::set<std::string> kNumerical{"time_step_fraction", "strain_rate", "rows", "precision", "quasi_static_step"};

/// Whether the packings of two settings scatter alike: they differ in numerical keys only, and show the same by the same model.
bool scatters_alike(const SettingResult& a, const SettingResult& b) {
  const auto physical = [](const SettingResult& r) {
    Changes changes = r.outcome.changes;
    std::erase_if(changes, [](const auto& change) { return kNumerical.contains(change.first); });
    return changes;
  };
  const auto shown = [](const SettingResult& r) {
    return std::count_if(r.errors.begin(), r.errors.end(),
                         [](const QuantityError& e) { return e.in_error && std::isfinite(e.error); });
  };
  return a.outcome.model == b.outcome.model && a.outcome.seeds == b.outcome.seeds && physical(a) == physical(b) &&
         shown(a) == shown(b);
}

/// All but noise and reached, for which it takes the other settings.
SettingResult compare_setting(const SettingOutcome& setting, const SettingOutcome& reference) {
  SettingResult result{setting, {}, kMissing, kMissing, kMissing, kMissing, kMissing, {}};
  double errors = 0, floors = 0, samplings = 0;
  int counted = 0;
  const bool paired = !setting.compared_with.empty();
  for (const StudyQuantity& theirs : paired ? setting.compared_with : reference.quantities) {
    const auto found = std::find_if(setting.quantities.begin(), setting.quantities.end(),
                                    [&](const StudyQuantity& q) { return q.name == theirs.name; });
    const QuantityError e = compare(found == setting.quantities.end() ? StudyQuantity{} : *found, setting.seeds, theirs,
                                    paired ? setting.seeds : reference.seeds);
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
  return result;
}

double pooled_sampling(const SettingResult& one, const std::vector<SettingResult>& all) {
  double squares = 0;
  int count = 0;
  for (const SettingResult& other : all) {
    if (!scatters_alike(one, other) || !std::isfinite(other.sampling)) continue;
    squares += other.sampling * other.sampling;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : kMissing;
}

/// Whether `other` shows every quantity that `one` shows; an error over fewer of them would be no better one.
bool shows_as_much(const SettingResult& other, const SettingResult& one) {
  for (std::size_t q = 0; q < one.errors.size(); ++q) {
    if (one.errors[q].in_error && std::isfinite(one.errors[q].error) && !std::isfinite(other.errors[q].error))
      return false;
  }
  return true;
}

/// Whether a data set that is safe from the energy balance at `one` may be stopped at `other`.
bool less_safe(const SettingResult& other, const SettingResult& one) {
  return near_the_stop(other.outcome.energy_residual) && !near_the_stop(one.outcome.energy_residual);
}

void find_dominated(std::vector<SettingResult>& results, std::size_t first) {
  for (std::size_t i = first; i < results.size(); ++i) {
    SettingResult& one = results[i];
    for (std::size_t j = first; j < results.size(); ++j) {
      const SettingResult& other = results[j];
      if (other.outcome.cost.particle_steps < one.outcome.cost.particle_steps && other.reached <= one.reached &&
          shows_as_much(other, one) && !less_safe(other, one))
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

double energy_residual_of(const Dataset& dataset) {
  double largest = 0;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration)
      largest = std::max(largest, dem::largest_energy_residual(test.record.rows));
  }
  return largest;
}

bool near_the_stop(double energy_residual) {
  return energy_residual > dem::ElementTestOptions().stop_energy_residual / 2;
}

std::vector<std::uint64_t> packings_of(const Dataset& dataset) {
  std::set<std::uint64_t> seeds;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration) seeds.insert(test.record.packing.seed);
  }
  return {seeds.begin(), seeds.end()};
}

SettingsStudy study_of(const std::string& kind, const std::string& error, Packings packings, const Json& base,
                       const std::vector<SettingOutcome>& outcomes, std::size_t judged) {
  SettingsStudy study{kind, error, packings, base, judged, {}};
  for (const SettingOutcome& outcome : outcomes) study.results.push_back(compare_setting(outcome, outcomes.front()));
  for (SettingResult& r : study.results) {
    r.noise = packings == Packings::given ? r.floor : pooled_sampling(r, study.results);
    r.reached = std::hypot(std::sqrt(std::max(r.error * r.error - r.floor * r.floor, 0.0)), r.noise);
  }
  find_dominated(study.results, judged);
  return study;
}

}  // namespace grainlaw::app
