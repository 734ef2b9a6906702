#include "fit/published/paper_claims.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "fit/published/verdicts.hpp"
#include "model/density_curves.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kExactStrain = 1e-6;  // of kinematics: exact but for the sums of logarithmic strain
constexpr double kSameJamming = 5e-4;  // within which the paper has D2 = D3
constexpr double kScaledAt = 0.15;     // ln(nu/nu_c) at which Eq. (15) is compared: within the rows of every mode

struct Measured {
  double value = kNaN, standard_error = kNaN;
  std::size_t packings = 0;
};

Measured mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (values.empty()) return {};
  double sum = 0, squares = 0;
  for (const double v : values) sum += v / n;
  for (const double v : values) squares += (v - sum) * (v - sum);
  return {sum, values.size() < 2 ? kNaN : std::sqrt(squares / (n - 1) / n), values.size()};
}

/// Tests of shear at constant volume of one mode and branch at one density, by seed.
using BySeed = std::map<std::uint64_t, const TestRecord*>;
using ByDensity = std::map<long, BySeed>;  // density in 1e-6

ByDensity shear_tests(const std::vector<TestRecord>& tests, Mode mode, Branch branch) {
  ByDensity found;
  for (const TestRecord& test : tests) {
    if (is_pure_shear(test) && test.path.segments.front().mode == mode && test.path.branch == branch)
      found[std::lround(test.path.nu * 1e6)][test.packing.seed] = &test;
  }
  return found;
}

using Value = std::function<double(const TestRecord&)>;

Value at_start(double Observation::*quantity) {
  return [=](const TestRecord& test) { return test.rows.front().*quantity; };
}

Value when_steady(double Observation::*quantity, double from) {
  return [=](const TestRecord& test) {
    double sum = 0, rows = 0;
    for (const Observation& row : test.rows) {
      if (row.eps_dev < from) continue;
      sum += row.*quantity;
      ++rows;
    }
    return sum / rows;
  };
}

/// a minus b over the packings that have both.
std::vector<double> differences(const BySeed& a, const Value& of_a, const BySeed& b, const Value& of_b) {
  std::vector<double> all;
  for (const auto& [seed, test] : a) {
    const auto other = b.find(seed);
    if (other == b.end()) continue;
    const double difference = of_a(*test) - of_b(*other->second);
    if (std::isfinite(difference)) all.push_back(difference);
  }
  return all;
}

class Claims {
 public:
  /// A sign, or with `printed` a value.
  void add(const std::string& where, const std::string& statement, double nu, const Measured& ours,
           Printed printed = {}) {
    if (!std::isfinite(ours.value)) return;
    all.push_back({where, statement, nu, ours.value, ours.standard_error, printed.value, ""});
    judge(all.back(), printed, ours.packings);
  }

  /// Two values that are said to be the same, at every density that both have; what matters is that part of the value.
  void add_equal(const std::string& where, const std::string& statement, const ByDensity& a, const ByDensity& b,
                 const Value& value, const char* curve) {
    for (const auto& [density, tests] : a) {
      const auto other = b.find(density);
      if (other == b.end()) continue;
      const std::vector<double> d = differences(tests, value, other->second, value);
      const Measured mean = mean_of(d);
      if (d.empty()) continue;
      double level = 0;
      for (const auto& [seed, test] : tests) level += value(*test) / static_cast<double>(tests.size());
      const double nu = static_cast<double>(density) / 1e6;
      all.push_back({where, statement, nu, mean.value, mean.standard_error, 0, ""});
      judge_equal(all.back(), difference_that_matters(curve, nu, level), d.size());
    }
  }

  std::vector<Claim> all;
};

std::string verdict_within(double difference, double range, double matters) {
  return std::abs(difference) > range ? "differs" : range <= matters ? "agrees" : "inconclusive";
}

/// Of the principal axes, ascending.
Eigen::Vector3d principal(const Eigen::Matrix3d& tensor) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
}

/// The first segment of the test is `mode` in its forward sense, along whatever axes.
bool goes_forward(const TestRecord& test, Mode mode) {
  const PathSegment& segment = test.path.segments.front();
  const Eigen::Vector3d own = principal(segment.direction.tensor), wanted = principal(direction_of(mode).tensor);
  return segment.mode == mode && (own.normalized() - wanted.normalized()).norm() < kExactStrain;
}

void add_kinematics(const std::vector<TestRecord>& tests, Claims& claims) {
  struct ModeOfTable {
    Mode mode;
    double rate, shape, lode;
  };
  // Table 1
  for (const ModeOfTable& row : {ModeOfTable{Mode::UNI, 1, 1, 60}, ModeOfTable{Mode::D2, std::numbers::sqrt3, 0, 30},
                                 ModeOfTable{Mode::D3, 1.5, 1, 60}}) {
    std::vector<double> rate, shape, lode;
    for (const TestRecord& test : tests) {
      if (!goes_forward(test, row.mode)) continue;
      const auto last =
          std::find_if(test.rows.rbegin(), test.rows.rend(), [](const auto& r) { return r.segment == 0; });
      if (last == test.rows.rend() || !(last->eps_dev > 0)) continue;
      rate.push_back(last->eps_dev / std::abs(principal(last->strain.tensor)(0)));
      shape.push_back(last->shape_strain);
      lode.push_back(last->lode_strain);
    }
    const std::string mode = to_string(row.mode);
    claims.add("Table 1", mode + ": deviatoric strain over the largest compression", kNaN, mean_of(rate),
               {row.rate, 0});
    claims.add("Table 1", mode + ": shape factor of strain", kNaN, mean_of(shape), {row.shape, 0});
    claims.add("Table 1", mode + ": Lode angle of strain [deg]", kNaN, mean_of(lode), {row.lode, 0});
  }
}

void add_uniaxial_end(const std::vector<TestRecord>& tests, Claims& claims) {
  std::vector<double> coordination;
  for (const TestRecord& test : tests) {
    if (!goes_forward(test, Mode::UNI)) continue;
    const auto last = std::find_if(test.rows.rbegin(), test.rows.rend(), [](const auto& r) { return r.segment == 0; });
    if (last != test.rows.rend() && std::abs(last->nu - 0.82) < 1e-3) coordination.push_back(last->C_star);
  }
  claims.add("Sec. 5.1", "UNI: C* at the largest density", 0.82, mean_of(coordination), {9.5, 0.05, 0.1});
}

void add_branches(const std::vector<TestRecord>& tests, double steady_from, Claims& claims) {
  const ByDensity unloading = shear_tests(tests, Mode::D2, Branch::unloading);
  const ByDensity loading = shear_tests(tests, Mode::D2, Branch::loading);
  for (const auto& [density, on_loading] : loading) {
    const auto other = unloading.find(density);
    if (other == unloading.end()) continue;
    const auto d =
        differences(on_loading, at_start(&Observation::C_star), other->second, at_start(&Observation::C_star));
    claims.add("Fig. 4", "C* before shear: loading branch above unloading branch", static_cast<double>(density) / 1e6,
               mean_of(d));
  }
  claims.add_equal("Fig. 5", "steady C* in D2: the same from both branches (difference)", loading, unloading,
                   when_steady(&Observation::C_star, steady_from), "C_star");
  claims.add_equal("Fig. 8", "steady P* in D2: the same from both branches (difference)", loading, unloading,
                   when_steady(&Observation::P_star, steady_from), "P_star");
  const auto drift = [&](const ByDensity& densities, double sign, const std::string& statement) {
    if (densities.empty()) return;
    const auto& [density, lowest] = *densities.begin();
    std::vector<double> d =
        differences(lowest, when_steady(&Observation::P_star, steady_from), lowest, at_start(&Observation::P_star));
    for (double& x : d) x *= sign;
    claims.add("Fig. 8", statement, static_cast<double>(density) / 1e6, mean_of(d));
  };
  drift(unloading, 1, "P* in D2 from the unloading branch: rises at the lowest density");
  drift(loading, -1, "P* in D2 from the loading branch: falls at the lowest density");
}

void add_collapse(const std::vector<TestRecord>& tests, double steady_from, Claims& claims) {
  const ByDensity D2 = shear_tests(tests, Mode::D2, Branch::unloading);
  const ByDensity D3 = shear_tests(tests, Mode::D3, Branch::unloading);
  claims.add_equal("Fig. 15", "steady s: D3 as D2 (difference)", D3, D2, when_steady(&Observation::s_par, steady_from),
                   "stress_ratio_max");
  claims.add_equal("Fig. 16", "steady F: D3 as D2 (difference)", D3, D2, when_steady(&Observation::F_par, steady_from),
                   "fabric_max");
}

/// Value of a curve of one mode with its error; on a bound it has none.
Measured value_of(const Calibration* fit, const DensityCurve& curve, double nu) {
  if (fit == nullptr || !has_values(fit->law, curve) || !is_told(fit->law, curve.groups.front())) return {};
  const double error = standard_error(fit->law, curve, nu);
  return {curve.of(fit->law.parameters, nu), error > 0 ? error : kNaN, static_cast<std::size_t>(fit->size.packings)};
}

/// Difference of two fits; packings that they have in common scatter alike, which this counts twice.
Measured operator-(const Measured& a, const Measured& b) {
  return {a.value - b.value, std::hypot(a.standard_error, b.standard_error), std::min(a.packings, b.packings)};
}

void add_orders(const Calibration& iso, const std::vector<Description>& descriptions, Claims& claims) {
  const auto mode = [&](const char* name) -> const Calibration* {
    const auto d =
        std::find_if(descriptions.begin(), descriptions.end(), [&](const auto& x) { return x.name == name; });
    return d == descriptions.end() ? nullptr : &d->calibration;
  };
  const Calibration *uni = mode("UNI"), *d3 = mode("D3");
  using P = const LawParameters<double>&;
  const auto jamming = [&](const std::string& what, const DensityCurve& unloading, const DensityCurve& steady_state) {
    const Measured a = value_of(&iso, unloading, 0), b = value_of(uni, unloading, 0),
                   c = value_of(&iso, steady_state, 0), d = value_of(d3, steady_state, 0);
    claims.add("Table 2", "nu_c of " + what + ": ISO above UNI", kNaN, a - b);
    claims.add("Table 2", "nu_c of " + what + ": UNI above D2", kNaN, b - c);
    claims.add("Table 2", "nu_c of " + what + ": ISO above D2", kNaN, a - c);
    const Measured difference = d - c;
    if (!std::isfinite(difference.value)) return;
    claims.all.push_back({"Table 2", "nu_c of " + what + ": D3 as D2 (difference)", kNaN, difference.value,
                          difference.standard_error, 0, ""});
    judge_equal(claims.all.back(), kSameJamming, difference.packings);
  };
  jamming("C*", {"", "", {"coordination"}, [](P p, double) { return p.isotropic.coordination.nu_c; }},
          {"", "", {"steady_coordination"}, [](P p, double) { return p.steady.coordination.nu_c; }});
  jamming("P*", {"", "", {"pressure"}, [](P p, double) { return p.isotropic.pressure.nu_c; }},
          {"", "", {"steady_pressure"}, [](P p, double) { return p.steady.pressure.nu_c; }});

  const auto named = [](const char* quantity) {
    return *std::find_if(density_curves().begin(), density_curves().end(),
                         [&](const DensityCurve& c) { return std::string(quantity) == c.quantity; });
  };
  const Measured rattlers = value_of(&iso, named("rattler_fraction"), 0.82);
  claims.add("Fig. 7", "rattlers: steady D2 above ISO", 0.82,
             value_of(&iso, named("steady_rattler_fraction"), 0.82) - rattlers);
  claims.add("Fig. 7", "rattlers: UNI above ISO", 0.82, value_of(uni, named("rattler_fraction"), 0.82) - rattlers);

  const DensityCurve scaled{"", "", {"pressure"}, [](P p, double x) {
                              const auto& law = p.isotropic.pressure;
                              return law.p0 * x * (1 - law.gamma_p * x);
                            }};
  const DensityCurve scaled_steady{"", "", {"steady_pressure"}, [](P p, double x) {
                                     const auto& law = p.steady.pressure;
                                     return law.p0 * x * (1 - law.gamma_p * x);
                                   }};
  const std::string where = fmt::format("scaled pressure at ln(nu/nu_c) = {}: ", kScaledAt);
  const Measured u = value_of(uni, scaled, kScaledAt);
  claims.add("Fig. 10", where + "ISO above UNI", kNaN, value_of(&iso, scaled, kScaledAt) - u);
  claims.add("Fig. 10", where + "UNI above D2", kNaN, u - value_of(&iso, scaled_steady, kScaledAt));
}

/// Eq. (19): one A* = a0 F_dev in both rows; ours are two, a B* F_dev. The error of B* is small beside that of a.
void add_anisotropy(const Calibration& fit, Claims& claims) {
  const CalibratedLaw& law = fit.law;
  constexpr double nu = 0.74;
  if (!has_values(law, "pressure") || nu < law.range.nu_min || nu > law.range.nu_max) return;
  const double B = law.parameters.isotropic.B_star(nu);
  for (const auto& [name, statement] :
       {std::pair{"anisotropy.a1", "A1*/F_dev, the pressure's row; the paper has one A"},
        {"anisotropy.a2", "A2*/F_dev, the row of deviatoric stress; the paper has one A"}}) {
    const Estimate& a = law.estimates[parameter_index(name)];
    if (a.status == Status::not_identified) continue;
    claims.add("Eq. 19", statement, nu,
               {a.value * B, a.standard_error * B, static_cast<std::size_t>(fit.size.packings)},
               {0.137, 0.0005, 0.0137});
  }
}

}  // namespace

void judge(Claim& claim, Printed printed, std::size_t packings) {
  const double n = static_cast<double>(packings);
  claim.published = printed.value;
  const bool is_sign = std::isnan(printed.value);
  const double range = packings < 2 ? kNaN : student_95(n - 1) * claim.standard_error;
  if (!is_sign && printed.half_digit == 0) {
    claim.verdict =
        std::abs(claim.ours - printed.value) <= kExactStrain * std::max(1.0, printed.value) ? "identity" : "differs";
  } else if (!std::isfinite(range)) {
    claim.verdict = "no error";
  } else if (is_sign) {
    claim.verdict = claim.ours > range ? "agrees" : claim.ours < -range ? "differs" : "undecided";
  } else {
    claim.matters = printed.matters;
    claim.verdict =
        verdict_within(claim.ours - printed.value, range * std::sqrt(n + 1) + printed.half_digit, printed.matters);
  }
}

void judge_equal(Claim& claim, double matters, std::size_t packings) {
  claim.published = 0;
  claim.matters = matters;
  const double range = packings < 2 ? kNaN : student_95(static_cast<double>(packings) - 1) * claim.standard_error;
  if (!std::isfinite(range))
    claim.verdict = "no error";
  else
    claim.verdict = verdict_within(claim.ours, range, matters);
}

std::vector<Claim> claims_of(const std::vector<TestRecord>& tests, const Calibration& calibration,
                             const std::vector<Description>& descriptions, double steady_from) {
  Claims claims;
  add_kinematics(tests, claims);
  add_uniaxial_end(tests, claims);
  add_orders(calibration, descriptions, claims);
  add_branches(tests, steady_from, claims);
  add_collapse(tests, steady_from, claims);
  add_anisotropy(calibration, claims);
  return claims.all;
}

}  // namespace grainlaw::fit
