#include "fit/published/verdicts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "model/density_curves.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

constexpr std::array kDensities{0.68, 0.70, 0.74, 0.80, 0.82};

/// Laws of steady shear belong to the calibration's D2, the others to its ISO.
bool of_shear(std::string_view group) {
  constexpr std::array shear{"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"};
  return group.starts_with("steady_") || std::find(shear.begin(), shear.end(), group) != shear.end();
}

void judge(Verdict& v, bool known, std::size_t packings) {
  const double n = static_cast<double>(packings);
  if (!known) v.ours = std::nan("");
  // on its bound a parameter has no error, and nothing is so and so many of none away
  v.distance = v.standard_error > 0 ? (v.ours - v.published) / (v.standard_error * std::sqrt(n + 1)) : std::nan("");
  if (!known)
    v.verdict = "not identified";
  else if (!std::isfinite(v.distance) || packings < 2)
    v.verdict = "no error";
  else
    v.verdict = std::abs(v.distance) <= student_95(n - 1) ? "agrees" : "differs";
}

/// `mode` of the laws on an unloading branch and `shear` of those in shear; empty: left out.
void add_verdicts(const CalibratedLaw& law, const std::string& mode, const std::string& shear, std::size_t packings,
                  std::vector<Verdict>& all) {
  const auto mode_of = [&](std::string_view group) { return of_shear(group) ? shear : mode; };
  const LawParameters<double> published = published_parameters(mode.empty() ? shear : mode);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const std::string_view name = info.name;
    const std::string whose = mode_of(name.substr(0, name.find('.')));
    const Estimate& estimate = law.estimates[i];
    const bool stands_for_itself = estimate.status != Status::fixed && !name.starts_with("anisotropy");
    if (!info.published || whose.empty() || !stands_for_itself) continue;
    Verdict v{whose, info.name, std::nullopt, estimate.value, estimate.standard_error, *fields(published)[i], 0, ""};
    judge(v, estimate.status != Status::not_identified, packings);
    all.push_back(v);
  }
  for (const DensityCurve& curve : density_curves()) {
    const std::string whose = mode_of(curve.groups.front());
    const bool known = has_values(law, curve);
    if (whose.empty() || !known) continue;
    for (const double nu : kDensities) {
      if (nu < law.range.nu_min - 1e-6 || nu > law.range.nu_max + 1e-6) continue;
      Verdict v{whose,
                curve.quantity,
                nu,
                curve.of(law.parameters, nu),
                standard_error(law, curve, nu),
                curve.of(published, nu),
                0,
                ""};
      judge(v, true, packings);
      all.push_back(v);
    }
  }
}

}  // namespace

std::vector<Verdict> verdicts_of(const CalibratedLaw& law, const std::vector<Description>& descriptions,
                                 std::size_t packings) {
  std::vector<Verdict> all;
  add_verdicts(law, "ISO", "D2", packings, all);
  for (const Description& d : descriptions) {
    const bool unloading = d.name == "UNI";
    add_verdicts(d.calibration.law, unloading ? d.name : "", unloading ? "" : d.name, packings, all);
  }
  return all;
}

}  // namespace grainlaw::fit
