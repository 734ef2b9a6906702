#include "app/settings_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/staged_laws.hpp"
#include "model/error.hpp"

namespace grainlaw::app {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

double value_of(const fit::Estimate& estimate) {
  return estimate.status == fit::Status::not_identified ? kMissing : estimate.value;
}

double cost_of(const Dataset& dataset, double& seconds) {
  double particle_steps = 0;
  seconds = 0;
  for (const DatasetTest& test : dataset.tests) {
    particle_steps += static_cast<double>(test.cost.steps) * static_cast<double>(test.record.packing.particles);
    seconds += test.cost.seconds;
  }
  return particle_steps;
}

/// Mean and standard error of the relative differences of a quantity, packing by packing.
QuantityError error_of(const std::string& quantity, const std::vector<double>& ours,
                       const std::vector<double>& reference) {
  const double n = static_cast<double>(ours.size());
  double mean_ours = 0, mean_reference = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    mean_ours += ours[i] / n;
    mean_reference += reference[i] / n;
  }
  QuantityError e{quantity, mean_ours, mean_ours / mean_reference - 1, 0};
  double squares = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double difference = (ours[i] - reference[i]) / mean_reference;
    squares += (difference - e.error) * (difference - e.error);
  }
  e.standard_error = std::sqrt(squares / (n - 1) / n);
  return e;
}

}  // namespace

std::pair<std::string, Json> change_from(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    throw InvalidInput(fmt::format("'{}': is no change; give KEY=VALUE with a key of SPEC", text));
  const std::string value = text.substr(at + 1);
  const Json number = Json::parse(value, nullptr, false);
  return {text.substr(0, at), number.is_number() ? number : Json(value)};
}

Setting setting_of(const std::string& name, const Spec& base, const Changes& changes) {
  Json document = Json(spec_to_json(base));
  for (const auto& [key, value] : changes) document[key] = value;
  return {name, changes, spec_from_json(document, name)};
}

PackingQuantities quantities_of(const Dataset& dataset, std::uint64_t seed) {
  std::vector<TestRecord> tests;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration && test.record.packing.seed == seed) tests.push_back(test.record);
  }
  const fit::DataSet data = fit::check_and_sort(tests);
  const fit::CalibrationOptions options;
  fit::Calibration c = fit::nothing_known();
  fit::fit_unloading_laws("ISO unloading", fit::isotropic_series(data, options), c, options, {});
  fit::fit_shear_laws(data, c, options, {});

  PackingQuantities result;
  const auto add = [&](const std::string& name, double value) {
    result.names.push_back(name);
    result.values.push_back(value);
  };
  const bool has_pressure = fit::has_values(c, "pressure"), has_coordination = fit::has_values(c, "coordination");
  for (const fit::ShearFit& shear : c.shear) {
    const std::string at = "@" + density_text(std::round(shear.nu * 1e6) / 1e6);
    add("P_star" + at, has_pressure && has_coordination ? c.parameters.isotropic.P_star(shear.nu) : kMissing);
    add("C_star" + at, has_coordination ? c.parameters.isotropic.coordination.C_star(shear.nu) : kMissing);
    add("s_max" + at, value_of(shear.s_max));
    add("beta_s" + at, value_of(shear.beta_s));
    add("F_max" + at, value_of(shear.F_max));
    add("beta_F" + at, value_of(shear.beta_F));
  }
  add("nu_c", has_pressure ? c.parameters.isotropic.pressure.nu_c : kMissing);
  return result;
}

SettingResult compare_setting(const Setting& setting, const Dataset& dataset, const Dataset& reference) {
  SettingResult result;
  result.setting = setting;
  result.particle_steps = cost_of(dataset, result.seconds);
  std::vector<PackingQuantities> ours, theirs;
  for (const std::uint64_t seed : reference.seeds) {
    ours.push_back(quantities_of(dataset, seed));
    theirs.push_back(quantities_of(reference, seed));
  }
  int counted = 0;
  for (std::size_t q = 0; q < theirs.front().names.size(); ++q) {
    std::vector<double> a, b;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      a.push_back(ours[i].values.at(q));
      b.push_back(theirs[i].values.at(q));
    }
    const QuantityError e = error_of(theirs.front().names[q], a, b);
    result.errors.push_back(e);
    if (e.quantity == "nu_c" || !std::isfinite(e.error)) continue;
    result.error += e.error * e.error;
    result.floor += e.standard_error * e.standard_error;
    ++counted;
  }
  result.error = std::sqrt(result.error / counted);
  result.floor = std::sqrt(result.floor / counted);
  return result;
}

void find_dominated(std::vector<SettingResult>& results) {
  const auto reached = [](const SettingResult& r) { return std::max(r.error, r.floor); };
  for (std::size_t i = 1; i < results.size(); ++i) {
    SettingResult& one = results[i];
    one.dominated = std::any_of(results.begin() + 1, results.end(), [&](const SettingResult& other) {
      return other.particle_steps < one.particle_steps && reached(other) <= reached(one);
    });
  }
}

}  // namespace grainlaw::app
