#include "chain/studies/settings_study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "dem/element_tests/element_run.hpp"
#include "dem/element_tests/energy_watch.hpp"
#include "model/files/fields_json.hpp"
#include "model/student.hpp"

namespace grainlaw::chain {
namespace {

// Keys of SPEC that say how to compute, and nothing of what is computed.
const std::set<std::string> kNumerical{"time_step_fraction", "strain_rate", "rows", "precision", "quasi_static_step"};

/// Whether the packings of two settings scatter alike: the same ones, computed otherwise at most, seen by the same model.
bool scatters_alike(const SettingResult& a, const SettingResult& b) {
  const auto physical = [](const SettingResult& r) {
    Changes changes = r.outcome.changes;
    std::erase_if(changes, [](const auto& change) { return kNumerical.contains(change.first); });
    return changes;
  };
  return a.outcome.model == b.outcome.model && a.outcome.seeds == b.outcome.seeds && physical(a) == physical(b);
}

/// Number of the quantities that count and that the setting shows.
std::ptrdiff_t shown(const SettingResult& r) {
  return std::ranges::count_if(r.errors, [](const QuantityError& e) { return e.in_error && std::isfinite(e.error); });
}

/// The quantities alone.
SettingResult compare_setting(const SettingOutcome& setting, const SettingOutcome& reference) {
  SettingResult result{setting, {}, kMissing, kMissing, kMissing, kMissing, kMissing, kMissing, {}, {}};
  const bool paired = !setting.compared_with.empty();
  for (const StudyQuantity& theirs : paired ? setting.compared_with : reference.quantities) {
    const auto found = std::find_if(setting.quantities.begin(), setting.quantities.end(),
                                    [&](const StudyQuantity& q) { return q.name == theirs.name; });
    result.errors.push_back(compare(found == setting.quantities.end() ? StudyQuantity{} : *found, setting.seeds, theirs,
                                    paired ? setting.seeds : reference.seeds));
  }
  return result;
}

/// Root mean square of `value` over the settings that scatter like `one`, as far as it is finite.
double pooled(const SettingResult& one, const std::vector<SettingResult>& all,
              const std::function<double(const SettingResult&)>& value) {
  double squares = 0;
  int count = 0;
  for (const SettingResult& other : all) {
    const double x = scatters_alike(one, other) ? value(other) : kMissing;
    if (!std::isfinite(x)) continue;
    squares += x * x;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : kMissing;
}

/// Error, floor and sampling: root mean squares over what counts, each over its unit.
void sum_up(SettingResult& result, const std::function<double(const QuantityError&)>& unit) {
  double errors = 0, floors = 0, samplings = 0;
  int counted = 0;
  for (const QuantityError& e : result.errors) {
    if (!e.in_error || !std::isfinite(e.error) || !(unit(e) > 0)) continue;
    const double square = unit(e) * unit(e);
    errors += e.error * e.error / square;
    floors += e.standard_error * e.standard_error / square;
    samplings += e.sampling * e.sampling / square;
    ++counted;
  }
  if (counted == 0) return;
  result.error = std::sqrt(errors / counted);
  result.floor = std::sqrt(floors / counted);
  result.sampling = std::sqrt(samplings / counted);
}

/// Standard error of quantity `q`, pooled; the reference differs from itself by nothing, which is no chance.
double chance_of(std::size_t q, const SettingResult& one, const std::vector<SettingResult>& all) {
  return pooled(one, all, [q](const SettingResult& r) {
    const double standard_error = r.errors[q].standard_error;
    return standard_error > 0 ? standard_error : kMissing;
  });
}

double pooled_sampling(const SettingResult& one, const std::vector<SettingResult>& all) {
  return pooled(one, all, [&](const SettingResult& r) { return shown(r) == shown(one) ? r.sampling : kMissing; });
}

/// All settings beside the first. `whole`: results of all packings, whose units stay; none: these are they.
std::vector<SettingResult> compared(const std::vector<SettingOutcome>& outcomes, Packings packings,
                                    const std::vector<SettingResult>* whole = nullptr) {
  std::vector<SettingResult> results;
  for (const SettingOutcome& outcome : outcomes) results.push_back(compare_setting(outcome, outcomes.front()));
  const bool given = packings == Packings::given;
  for (std::size_t i = 0; given && i < results.size(); ++i) {
    for (std::size_t q = 0; q < results[i].errors.size(); ++q)
      results[i].errors[q].chance = whole != nullptr ? (*whole)[i].errors[q].chance : chance_of(q, results[i], results);
  }
  for (SettingResult& r : results) {
    sum_up(r, [given](const QuantityError& e) { return given ? e.chance : 1.0; });
    if (given && std::isfinite(r.error)) r.floor = 1;  // pooled, in units of itself
  }
  for (SettingResult& r : results) {
    r.noise = given ? r.floor : pooled_sampling(r, results);
    r.reached = std::hypot(std::sqrt(std::max(r.error * r.error - r.floor * r.floor, 0.0)), r.noise);
  }
  return results;
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

/// All settings with one packing left out of those that have it.
struct LeftOut {
  std::uint64_t seed = 0;
  std::vector<SettingResult> results;
};

/// reached^2 before it is kept above the noise^2: what an error below its floor says of the setting is chance, too.
double unbounded_square(const SettingResult& r) { return r.error * r.error - r.floor * r.floor + r.noise * r.noise; }

/// From values with each of n packings left out in turn.
struct Jackknife {
  double error = kMissing;  ///< standard error; NaN for fewer than three
  double degrees_of_freedom = kMissing;
};

Jackknife jackknife(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 3) return {};
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {std::sqrt(squares * (n - 1) / n), n - 1};
}

bool has(const SettingOutcome& outcome, std::uint64_t seed) {
  return std::find(outcome.seeds.begin(), outcome.seeds.end(), seed) != outcome.seeds.end();
}

SettingOutcome without(SettingOutcome outcome, std::uint64_t seed) {
  const auto found = std::find(outcome.seeds.begin(), outcome.seeds.end(), seed);
  if (found == outcome.seeds.end()) return outcome;
  const auto column = std::distance(outcome.seeds.begin(), found);
  for (auto* quantities : {&outcome.quantities, &outcome.compared_with}) {
    for (StudyQuantity& quantity : *quantities) quantity = without_packing(quantity, column);
  }
  if (outcome.seeds.size() >= 3) outcome.seeds.erase(found);  // of fewer nothing is left to be shown
  return outcome;
}

/// Of unbounded_square() of setting `one` minus that of setting `other`, over the packings that one of them has.
Jackknife difference_of_squares(const std::vector<SettingResult>& results, std::size_t one, std::size_t other,
                                const std::vector<LeftOut>& left_out) {
  std::vector<double> differences;
  for (const LeftOut& left : left_out) {
    if (has(results[one].outcome, left.seed) || has(results[other].outcome, left.seed))
      differences.push_back(unbounded_square(left.results[one]) - unbounded_square(left.results[other]));
  }
  return jackknife(differences);
}

/// Whether `one` is worse than `other` beyond what chance does to one of `rivals` comparisons in twenty.
bool beyond_chance(const std::vector<SettingResult>& results, std::size_t one, std::size_t other, std::size_t rivals,
                   const std::vector<LeftOut>& left_out) {
  const Jackknife chance = difference_of_squares(results, one, other, left_out);
  if (!std::isfinite(chance.error)) return false;
  // Near zero a squared error is no linear function of the packings; by chance alone it has the variance 2 floor^4, at most.
  const double squares = std::pow(results[one].floor, 4) + std::pow(results[other].floor, 4);
  const double error = std::sqrt(chance.error * chance.error + 2 * squares);
  const double t = student_quantile(1 - 0.025 / static_cast<double>(rivals), chance.degrees_of_freedom);
  return unbounded_square(results[one]) - unbounded_square(results[other]) >= t * error;
}

void find_dominated(SettingsStudy& study, const std::vector<LeftOut>& left_out) {
  std::vector<SettingResult>& results = study.results;
  for (std::size_t i = study.judged; i < results.size(); ++i) {
    SettingResult& one = results[i];
    const auto dearer = [&](const SettingResult& other) {
      return other.outcome.cost.particle_steps > one.outcome.cost.particle_steps;
    };
    std::vector<std::size_t> rivals;
    for (std::size_t j = study.judged; j < results.size(); ++j) {
      if (j != i && !dearer(results[j]) && shows_as_much(results[j], one) && !less_safe(results[j], one))
        rivals.push_back(j);
    }
    for (const std::size_t j : rivals) {
      const bool as_dear = results[j].outcome.cost.particle_steps == one.outcome.cost.particle_steps;
      if (as_dear ? !(results[j].reached < one.reached) : !(results[j].reached <= one.reached)) continue;
      if (beyond_chance(results, i, j, rivals.size(), left_out)) {
        one.dominated_by.push_back(results[j].outcome.name);
      } else if (!as_dear) {
        one.perhaps_dominated_by.push_back(results[j].outcome.name);
      }
    }
  }
}

OrderedJson result_to_json(const SettingResult& r) {
  const SettingOutcome& outcome = r.outcome;
  OrderedJson object{{"setting", outcome.name}};
  OrderedJson& changes = object["changes"] = OrderedJson::object();
  for (const auto& [key, value] : outcome.changes) changes[key] = value;
  object["packings"] = outcome.seeds.size();
  object["particle_steps"] = outcome.cost.particle_steps;
  object["seconds"] = outcome.cost.seconds;
  object["fit_seconds"] = outcome.cost.fit_seconds;
  object["energy_residual"] = outcome.energy_residual;
  object["model"] = outcome.model.empty() ? OrderedJson() : OrderedJson(outcome.model);
  object["same_packings"] = !outcome.compared_with.empty();
  object["error"] = number_or_null(r.error);
  object["floor"] = number_or_null(r.floor);
  object["sampling"] = number_or_null(r.sampling);
  object["noise"] = number_or_null(r.noise);
  object["reached"] = number_or_null(r.reached);
  object["reached_standard_error"] = number_or_null(r.reached_error);
  object["dominated"] = !r.dominated_by.empty();
  object["dominated_by"] = r.dominated_by;
  object["perhaps_dominated_by"] = r.perhaps_dominated_by;
  object["note"] = outcome.note;
  object["quantities"] = fields_to_json(r.errors);
  return object;
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
  SettingsStudy study{kind, error, packings, base, judged, compared(outcomes, packings)};
  std::set<std::uint64_t> seeds;
  for (const SettingOutcome& outcome : outcomes) seeds.insert(outcome.seeds.begin(), outcome.seeds.end());
  std::vector<LeftOut> left_out;
  for (const std::uint64_t seed : seeds) {
    std::vector<SettingOutcome> rest;
    for (const SettingOutcome& outcome : outcomes) rest.push_back(without(outcome, seed));
    left_out.push_back({seed, compared(rest, packings, &study.results)});
  }
  for (std::size_t i = 0; i < study.results.size(); ++i) {
    std::vector<double> reached;
    for (const LeftOut& left : left_out) {
      if (has(outcomes[i], left.seed)) reached.push_back(left.results[i].reached);
    }
    study.results[i].reached_error = jackknife(reached).error;
  }
  find_dominated(study, left_out);
  return study;
}

OrderedJson study_to_json(const SettingsStudy& study) {
  OrderedJson document = {{"format", "grainlaw study"}, {"format_version", 1}, {"study", study.kind}};
  document["base"] = study.base;
  document["error"] = study.error;
  document["reference"] = study.results.front().outcome.name;
  const SettingResult& judged = study.results.at(study.judged);
  document["default"] = {{"setting", judged.outcome.name},
                         {"dominated", !judged.dominated_by.empty()},
                         {"dominated_by", judged.dominated_by},
                         {"perhaps_dominated_by", judged.perhaps_dominated_by}};
  OrderedJson& all = document["settings"] = OrderedJson::array();
  for (const SettingResult& r : study.results) all.push_back(result_to_json(r));
  return document;
}

SettingsStudy study_from_json(const Json& document) {
  SettingsStudy study;
  study.kind = document.at("study");
  study.error = document.at("error");
  study.packings = study.kind == "dem" ? Packings::given : Packings::chosen;
  for (const Json& object : document.at("settings")) {
    SettingResult& r = study.results.emplace_back();
    r.outcome.name = object.at("setting");
    r.outcome.cost.particle_steps = object.at("particle_steps");
    r.outcome.energy_residual = object.at("energy_residual");
    r.noise = number_or_nan(object.at("noise"));
    r.reached = number_or_nan(object.at("reached"));
    r.reached_error = number_or_nan(object.at("reached_standard_error"));
    r.dominated_by = object.at("dominated_by").get<std::vector<std::string>>();
    if (r.outcome.name == document.at("default").at("setting")) study.judged = study.results.size() - 1;
  }
  return study;
}

}  // namespace grainlaw::chain
