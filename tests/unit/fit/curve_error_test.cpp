#include "fit/statistics/curve_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/staged_laws.hpp"

namespace grainlaw::fit {
namespace {

const DensityCurve& curve(const std::string& name) {
  for (const DensityCurve& c : density_curves()) {
    if (c.quantity == name) return c;
  }
  throw std::logic_error(name);
}

/// Eq. (20) for F_max with errors of Q_c and alpha that go together; Q_limit on its bound.
CalibratedLaw calibrated() {
  CalibratedLaw c = nothing_known().law;
  c.parameters = published_parameters();
  const auto set = [&](const char* name, Status status, double error) {
    const std::size_t i = parameter_index(name);
    c.estimates[i] = {*fields(c.parameters)[i], error, status, ""};
    c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = error * error;
  };
  set("fabric_max.Q_limit", Status::at_bound, 0);
  set("fabric_max.Q_c", Status::fitted, 0.01);
  set("fabric_max.alpha", Status::fitted, 0.3);
  const auto q = static_cast<Eigen::Index>(parameter_index("fabric_max.Q_c"));
  const auto a = static_cast<Eigen::Index>(parameter_index("fabric_max.alpha"));
  c.covariance(q, a) = c.covariance(a, q) = 0.8 * 0.01 * 0.3;
  return c;
}

TEST(CurveError, IsThatOfTheDeltaMethod) {
  const CalibratedLaw c = calibrated();
  const ExponentialLaw<double>& law = c.parameters.fabric_max;
  for (const double nu : {0.67, 0.70, 0.82}) {
    const double y = nu / c.parameters.shear_nu_c - 1, decay = std::exp(-law.alpha * y);
    const double dQ = decay, da = -law.Q_c * y * decay;
    const double variance = dQ * dQ * 1e-4 + da * da * 0.09 + 2 * dQ * da * 0.8 * 0.003;
    EXPECT_NEAR(standard_error(c, curve("fabric_max"), nu) / std::sqrt(variance), 1, 1e-6) << nu;
  }
}

TEST(CurveError, IsUndefinedWhereAParameterHasNone) {
  CalibratedLaw c = calibrated();
  const auto q = static_cast<Eigen::Index>(parameter_index("fabric_max.Q_c"));
  c.covariance.row(q).setZero();
  c.covariance.col(q).setZero();
  EXPECT_TRUE(std::isnan(standard_error(c, curve("fabric_max"), 0.7)));
  EXPECT_TRUE(std::isnan(standard_error(c, curve("C_star"), 0.7)));
}

}  // namespace
}  // namespace grainlaw::fit
