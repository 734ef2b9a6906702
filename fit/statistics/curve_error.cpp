#include "fit/statistics/curve_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace grainlaw::fit {
namespace {

constexpr double kStepInErrors = 1e-3;  // of the central difference: curves are straight over a thousandth of an error

bool reads(const DensityCurve& curve, std::string_view parameter) {
  const std::string_view group = parameter.substr(0, parameter.find('.'));
  return std::any_of(curve.groups.begin(), curve.groups.end(), [&](const char* name) { return group == name; });
}

}  // namespace

double standard_error(const CalibratedLaw& law, const DensityCurve& curve, double nu) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    if (!reads(curve, parameter_table()[i].name)) continue;
    const Estimate& estimate = law.estimates[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double error = std::sqrt(law.covariance(k, k));
    if (estimate.status == Status::fixed || estimate.status == Status::at_bound) continue;
    if (!(error > 0)) return std::numeric_limits<double>::quiet_NaN();
    const double step = kStepInErrors * error;
    LawParameters<double> p = law.parameters;
    double& x = *fields(p)[i];
    const double x_0 = x;
    x = x_0 + step;
    const double above = curve.of(p, nu);
    x = x_0 - step;
    gradient(k) = (above - curve.of(p, nu)) / (2 * step);
  }
  return std::sqrt(gradient.dot(law.covariance * gradient));
}

}  // namespace grainlaw::fit
