#include "model/calibrated_law.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/student.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

/// Whether `name`, of parameter_table(), is `group` or one of its parameters.
bool is_of(std::string_view name, std::string_view group) {
  return name.starts_with(group) && (name.size() == group.size() || name[group.size()] == '.');
}

bool has_value(const CalibratedLaw& law, std::size_t i) { return law.estimates[i].status != Status::not_identified; }

/// Parameters, or groups of them, that the equations of `rung` read.
std::vector<std::string_view> read_by(Rung rung, Coupling coupling) {
  std::vector<std::string_view> groups{"coordination", "rattlers", "pressure", "shear.nu_c", "stress_ratio_max"};
  if (rung == Rung::memory)
    groups.insert(groups.end(), {"fabric_max", "steady_coordination", "steady_rattlers", "steady_pressure", "memory"});
  else
    groups.push_back("stress_rate");
  if (rung == Rung::evolution)
    groups.insert(groups.end(),
                  {"fabric_max", "fabric_rate", coupling == Coupling::single ? "anisotropy.a0" : "anisotropy.a2"});
  return groups;
}

/// True for the alpha of an Eq. (20) whose Q_c is zero: the law does not depend on it.
bool without_exponential(const CalibratedLaw& law, std::size_t i) {
  const ParameterInfo& info = parameter_table()[i];
  const std::string name = info.name;
  if (info.equation != std::string("20") || !name.ends_with(".alpha")) return false;
  const std::size_t Q_c = parameter_index(name.substr(0, name.find('.')) + ".Q_c");
  return has_value(law, Q_c) && *fields(law.parameters)[Q_c] == 0;
}

constexpr double kPlausibleJamming = 0.02;  // random packings of spheres jam within .64 ... .68

/// How large a parameter is when nothing is known of it.
double plausible_size(std::size_t i) {
  const ParameterInfo& info = parameter_table()[i];
  const std::string name = info.name;
  if (name.ends_with(".nu_c")) return kPlausibleJamming;
  if (name.ends_with(".Q_limit")) return parameter_table()[i + 1].start;
  return info.start != 0 ? std::abs(info.start) : std::min(1.0, info.upper);
}

}  // namespace

double Estimate::half_width() const {
  if (!std::isfinite(standard_error) || std::isnan(degrees_of_freedom)) return std::nan("");
  return student_95(degrees_of_freedom) * standard_error;
}

bool says_nothing(const CalibratedLaw& law, std::size_t parameter) {
  const Estimate& e = law.estimates[parameter];
  const bool of_jamming = std::string_view(parameter_table()[parameter].name).ends_with(".nu_c");
  return e.half_width() > std::max(of_jamming ? 0 : std::abs(e.value), plausible_size(parameter));
}

bool has_values(const CalibratedLaw& law, std::string_view group) {
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    if (is_of(parameter_table()[i].name, group) && !has_value(law, i)) return false;
  }
  return true;
}

bool is_told(const CalibratedLaw& law, std::string_view group) {
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Status status = law.estimates[i].status;
    if (is_of(parameter_table()[i].name, group) && (status == Status::fitted || status == Status::at_bound))
      return true;
  }
  return false;
}

bool knows_fabric(const LawParameters<double>& law) {
  return !std::isnan(law.fabric_max.Q_limit + law.fabric_max.Q_c + law.fabric_rate.Q_limit + law.fabric_rate.Q_c);
}

void forget_unknown_fabric(CalibratedLaw& law) {
  const auto value = fields(law.parameters);
  for (const std::string_view group : {"fabric_max", "fabric_rate"}) {
    bool known = true;
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (is_of(parameter_table()[i].name, group)) known = known && (has_value(law, i) || without_exponential(law, i));
    }
    for (std::size_t i = 0; i < kParameterCount && !known; ++i) {
      if (is_of(parameter_table()[i].name, group)) *value[i] = std::nan("");
    }
  }
}

std::optional<std::size_t> missing_parameter(const CalibratedLaw& law, Rung rung) {
  const std::vector<std::string_view> needed = read_by(rung, law.coupling);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const bool is_needed = std::any_of(needed.begin(), needed.end(),
                                       [&](std::string_view group) { return is_of(parameter_table()[i].name, group); });
    if (is_needed && !has_value(law, i) && !without_exponential(law, i)) return i;
  }
  return std::nullopt;
}

void require_parameters(const CalibratedLaw& law, Rung rung, const std::string& name) {
  const auto missing = missing_parameter(law, rung);
  if (!missing) return;
  const std::string& note = law.estimates[*missing].note;
  throw InvalidInput(fmt::format(
      "{}: parameters.{}: is not identified and the {} model needs it{}{}; calibrate with tests that contain "
      "it",
      name, parameter_table()[*missing].name, to_string(rung), note.empty() ? "" : ": ", note));
}

std::vector<std::string> left_out_rungs(const CalibratedLaw& law) {
  std::map<std::size_t, std::vector<std::string>> rungs;  // by the parameter that they lack
  for (const Rung rung : kRungs) {
    if (const auto missing = missing_parameter(law, rung)) rungs[*missing].push_back(to_string(rung));
  }
  std::vector<std::string> lines;
  for (const auto& [parameter, without] : rungs) {
    const std::string& note = law.estimates[parameter].note;
    lines.push_back(fmt::format("{} left out: parameters.{} is not identified{}{}", fmt::join(without, ", "),
                                parameter_table()[parameter].name, note.empty() ? "" : ": ", note));
  }
  return lines;
}

std::vector<Rung> calibrated_rungs(const CalibratedLaw& law) {
  std::vector<Rung> rungs;
  for (const Rung rung : kRungs) {
    if (!missing_parameter(law, rung)) rungs.push_back(rung);
  }
  return rungs;
}

std::vector<std::size_t> uncertain_parameters(const CalibratedLaw& law) {
  std::vector<std::size_t> indices;
  for (Eigen::Index i = 0; i < law.covariance.rows(); ++i) {
    if (law.covariance(i, i) > 0) indices.push_back(static_cast<std::size_t>(i));
  }
  return indices;
}

std::string available_bands(const CalibratedLaw& law) {
  const std::string of_law = law.rehearsals.empty()
                                 ? "; the law's own error is not in them: no other path was rehearsed"
                                 : "; with the law's own error";
  if (uncertain_parameters(law).empty())
    return "none: the parameters have no covariance; calibrate on two packings or more";
  if (!std::isfinite(law.scatter.compression))
    return "95 %, of the mean curve only: the parameters have no scatter between packings; calibrate again, with two "
           "seeds or more" +
           of_law;
  return "95 %, of the mean curve and of a single run" + of_law;
}

}  // namespace grainlaw
