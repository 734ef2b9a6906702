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

void judge(Verdict& v, bool known, int packings, double degrees_of_freedom) {
  const double n = packings;
  if (!known) v.ours = std::nan("");
  v.matters = difference_that_matters(v.quantity, v.nu, v.published);
  // on its bound a parameter has no error, and nothing is so and so many of none away
  const double scatter = v.standard_error > 0 ? v.standard_error * std::sqrt(n + 1) : std::nan("");
  v.distance = (v.ours - v.published) / scatter;
  v.range = packings < 2 ? std::nan("")
                         : student_95(std::isfinite(degrees_of_freedom) ? degrees_of_freedom : n - 1) * scatter;
  if (!known)
    v.verdict = "not identified";
  else if (!std::isfinite(v.distance) || packings < 2)
    v.verdict = "no error";
  else if (std::abs(v.ours - v.published) > v.range)
    v.verdict = "differs";
  else
    v.verdict = v.range <= v.matters ? "agrees" : "inconclusive";
}

/// `mode` of the laws on an unloading branch and `shear` of those in shear; empty: left out.
void add_verdicts(const CalibratedLaw& law, const std::string& mode, const std::string& shear, int packings,
                  std::vector<Verdict>& all) {
  const auto mode_of = [&](std::string_view group) { return of_shear(group) ? shear : mode; };
  const LawParameters<double> published = published_parameters(mode.empty() ? shear : mode);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const std::string_view name = info.name;
    const std::string_view group = name.substr(0, name.find('.'));
    const std::string whose = mode_of(group);
    const Estimate& estimate = law.estimates[i];
    const bool tied_alone = estimate.status == Status::tied && !is_told(law, group),
               stands_for_itself = estimate.status != Status::fixed && !tied_alone && !name.starts_with("anisotropy");
    if (!info.published || whose.empty() || !stands_for_itself) continue;
    Verdict v{whose, info.name, std::nullopt, estimate.value, estimate.standard_error, *fields(published)[i]};
    judge(v, estimate.status != Status::not_identified, packings, estimate.degrees_of_freedom);
    all.push_back(v);
  }
  for (const DensityCurve& curve : density_curves()) {
    const std::string whose = mode_of(curve.groups.front());
    const bool known = has_values(law, curve) && is_told(law, curve.groups.front());
    if (whose.empty() || !known) continue;
    for (const double nu : kDensities) {
      if (nu < law.range.nu_min - 1e-6 || nu > law.range.nu_max + 1e-6) continue;
      Verdict v{whose,
                curve.quantity,
                nu,
                curve.of(law.parameters, nu),
                standard_error(law, curve, nu),
                curve.of(published, nu)};
      judge(v, true, packings, degrees_of_freedom(law, curve, nu));
      all.push_back(v);
    }
  }
}

}  // namespace

double difference_that_matters(const std::string& quantity, std::optional<double> nu, double published) {
  const auto is = [&](const char* name) { return quantity.find(name) != std::string::npos; };
  const auto of_shear_curve = [&] {
    return is("stress_ratio_max") ? 0.05 : is("stress_rate") ? 0.2 : is("fabric_max") ? 0.07 : 0.3;
  };
  if (nu) {
    if (is("C_star")) return published * (*nu >= 0.70 - 1e-9 ? 0.01 : 0.02);
    if (is("rattler_fraction")) return *nu >= 0.78 ? 0.0015 : 0.25 * published;
    if (is("P_star")) return published * (*nu >= 0.70 - 1e-9 ? 0.02 : 0.05);
    return published * of_shear_curve();
  }
  if (is(".nu_c")) return 0.0025;
  if (is("overlap.D")) return 0.02;
  if (is("fabric.g3")) return 0.045;
  if (is("gamma_p")) return 0.1;
  if (is(".Q_")) {  // what moves the curve by as much as matters
    constexpr double middle = 0.74;
    const LawParameters<double> paper = published_parameters();
    for (const DensityCurve& curve : density_curves()) {
      if (quantity.starts_with(std::string(curve.quantity) + ".")) return curve.of(paper, middle) * of_shear_curve();
    }
  }
  return 0.1 * std::abs(published);
}

std::vector<Verdict> verdicts_of(const CalibratedLaw& law, const std::vector<Description>& descriptions, int packings) {
  std::vector<Verdict> all;
  add_verdicts(law, "ISO", "D2", packings, all);
  for (const Description& d : descriptions) {
    const bool unloading = d.name == "UNI";
    add_verdicts(d.calibration.law, unloading ? d.name : "", unloading ? "" : d.name, d.calibration.size.packings, all);
  }
  return all;
}

std::string other_than_the_papers(const std::vector<TestRecord>& tests) {
  PackingInfo paper;
  paper.size_width = 3;
  return tests.empty() ? "" : other_material(tests.front().packing, paper);
}

void set_aside_other_material(ModeComparison& modes, const std::vector<TestRecord>& tests) {
  if (other_than_the_papers(tests).empty()) return;
  for (Verdict& v : modes.verdicts) v.verdict = kAnotherMaterial;
  for (Claim& claim : modes.claims) {
    const bool is_number = claim.published > 0 && std::isfinite(claim.matters);
    if (is_number) claim.verdict = kAnotherMaterial;
  }
}

}  // namespace grainlaw::fit
