#include "model/density_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace grainlaw {
namespace {

constexpr double kStepInErrors = 1e-3;  // of the central difference: curves are straight over a thousandth of an error

bool reads(const DensityCurve& curve, std::string_view parameter) {
  const std::string_view group = parameter.substr(0, parameter.find('.'));
  return std::any_of(curve.groups.begin(), curve.groups.end(), [&](const char* name) { return group == name; });
}

/// To all parameters; NaN where one that the curve reads has no error.
Eigen::VectorXd gradient_of(const CalibratedLaw& law, const DensityCurve& curve, double nu) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    if (!reads(curve, parameter_table()[i].name)) continue;
    const Estimate& estimate = law.estimates[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double error = std::sqrt(law.covariance(k, k));
    if (estimate.status == Status::fixed || estimate.status == Status::at_bound) continue;
    if (!(error > 0)) return Eigen::VectorXd::Constant(kParameterCount, std::numeric_limits<double>::quiet_NaN());
    const double step = kStepInErrors * error;
    LawParameters<double> p = law.parameters;
    double& x = *fields(p)[i];
    const double x_0 = x;
    x = x_0 + step;
    const double above = curve.of(p, nu);
    x = x_0 - step;
    gradient(k) = (above - curve.of(p, nu)) / (2 * step);
  }
  return gradient;
}

}  // namespace

const std::vector<DensityCurve>& density_curves() {
  using P = const LawParameters<double>&;
  static const std::vector<DensityCurve> curves{
      {"C_star", "{C}*", {"coordination"}, [](P p, double nu) { return p.isotropic.coordination.C_star(nu); }},
      {"rattler_fraction",
       "{φ}_{r}",
       {"rattlers", "coordination"},
       [](P p, double nu) { return p.isotropic.rattlers.fraction(nu, p.isotropic.coordination.nu_c); }},
      {"P_star",
       "{P}*",
       {"pressure", "coordination", "rattlers"},
       [](P p, double nu) { return p.isotropic.P_star(nu); }},
      {"steady_C_star",
       "{C}*",
       {"steady_coordination"},
       [](P p, double nu) { return p.steady.coordination.C_star(nu); }},
      {"steady_rattler_fraction",
       "{φ}_{r}",
       {"steady_rattlers", "steady_coordination"},
       [](P p, double nu) { return p.steady.rattlers.fraction(nu, p.steady.coordination.nu_c); }},
      {"steady_P_star",
       "{P}*",
       {"steady_pressure", "steady_coordination", "steady_rattlers"},
       [](P p, double nu) { return p.steady.P_star(nu); }},
      {"stress_ratio_max",
       "{s}_{max}",
       {"stress_ratio_max"},
       [](P p, double nu) { return p.stress_ratio_max.value(nu, p.shear_nu_c); }},
      {"stress_rate", "{β}_{s}", {"stress_rate"}, [](P p, double nu) { return p.stress_rate.value(nu, p.shear_nu_c); }},
      {"fabric_max", "{F}_{max}", {"fabric_max"}, [](P p, double nu) { return p.fabric_max.value(nu, p.shear_nu_c); }},
      {"fabric_rate", "{β}_{F}", {"fabric_rate"}, [](P p, double nu) {
         return p.fabric_rate.value(nu, p.shear_nu_c);
       }}};
  return curves;
}

bool has_values(const CalibratedLaw& law, const DensityCurve& curve) {
  return std::ranges::all_of(curve.groups, [&](const char* group) { return has_values(law, group); });
}

double standard_error(const CalibratedLaw& law, const DensityCurve& curve, double nu) {
  const Eigen::VectorXd gradient = gradient_of(law, curve, nu);
  return std::sqrt(gradient.dot(law.covariance * gradient));
}

double degrees_of_freedom(const CalibratedLaw& law, const DensityCurve& curve, double nu) {
  const Eigen::VectorXd gradient = gradient_of(law, curve, nu);
  const Eigen::VectorXd shares = gradient.cwiseProduct(law.covariance * gradient).cwiseAbs();
  double inverse = 0;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const double share = shares(static_cast<Eigen::Index>(i));
    if (share != 0) inverse += share / law.estimates[i].degrees_of_freedom;
  }
  return shares.sum() / inverse;
}

std::vector<CurvePoint> curve_points(const LawParameters<double>& ours, const LawParameters<double>& published,
                                     double nu_min, double nu_max, int per_unit) {
  constexpr double slack = 1e-9;
  std::vector<CurvePoint> points;
  for (const DensityCurve& curve : density_curves()) {
    for (double k = std::ceil((nu_min - slack) * per_unit); k / per_unit <= nu_max + slack; ++k) {
      points.push_back({&curve, k / per_unit, curve.of(ours, k / per_unit), curve.of(published, k / per_unit)});
    }
  }
  return points;
}

}  // namespace grainlaw
