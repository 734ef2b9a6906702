#include "model/density_curves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

namespace grainlaw {
namespace {

bool belongs(std::string_view name, std::string_view group) {
  return name.starts_with(group) && name.size() > group.size() && name[group.size()] == '.';
}

// A curve moves with each parameter of its groups and with no other (Eq. (20)'s nu_c is fixed and counts for none).
TEST(DensityCurves, ReadTheParametersOfTheirGroupsAndNoOthers) {
  const double nu = 0.71;
  for (const DensityCurve& curve : density_curves()) {
    const double before = curve.of(published_parameters(), nu);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const std::string_view name = parameter_table()[i].name;
      if (name == "shear.nu_c") continue;
      LawParameters<double> moved = published_parameters();
      double& value = *fields(moved)[i];
      value += 1e-3 * (std::abs(value) + 0.1);
      bool own = false;
      for (const char* group : curve.groups) own = own || belongs(name, group);
      const bool changed = curve.of(moved, nu) != before;
      // C* reads no rattler parameter although P* does; phi_r reads of Eq. (11) only nu_c
      if (!own) {
        EXPECT_FALSE(changed) << curve.quantity << " moves with " << name;
      } else if (std::string_view(curve.quantity).find("rattler") == std::string_view::npos || name.ends_with("nu_c")) {
        EXPECT_TRUE(changed) << curve.quantity << " does not move with " << name;
      }
    }
  }
}

TEST(DensityCurves, PointsCoverTheRangeEndsIncluded) {
  const auto points = curve_points(published_parameters(), published_parameters(), 0.68, 0.82);
  EXPECT_EQ(points.size(), 8 * density_curves().size());  // .68 .70 ... .82
  for (const CurvePoint& point : points) EXPECT_EQ(point.ours, point.published);
  EXPECT_NEAR(points.front().nu, 0.68, 1e-12);
  EXPECT_NEAR(points.back().nu, 0.82, 1e-12);
  EXPECT_EQ(curve_points(published_parameters(), published_parameters(), 0.681, 0.699).size(), 0u);
}

const DensityCurve& curve_named(const std::string& name) {
  for (const DensityCurve& c : density_curves()) {
    if (c.quantity == name) return c;
  }
  throw std::logic_error(name);
}

/// Eq. (20) for F_max with errors of Q_c and alpha that go together; Q_limit on its bound.
CalibratedLaw with_fabric_errors() {
  CalibratedLaw c;
  c.parameters = published_parameters();
  c.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
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

TEST(DensityCurveError, IsThatOfTheDeltaMethod) {
  const CalibratedLaw c = with_fabric_errors();
  const ExponentialLaw<double>& law = c.parameters.fabric_max;
  for (const double nu : {0.67, 0.70, 0.82}) {
    const double y = nu / c.parameters.shear_nu_c - 1, decay = std::exp(-law.alpha * y);
    const double dQ = decay, da = -law.Q_c * y * decay;
    const double variance = dQ * dQ * 1e-4 + da * da * 0.09 + 2 * dQ * da * 0.8 * 0.003;
    EXPECT_NEAR(standard_error(c, curve_named("fabric_max"), nu) / std::sqrt(variance), 1, 1e-6) << nu;
  }
}

TEST(DensityCurveError, IsUndefinedWhereAParameterHasNone) {
  CalibratedLaw c = with_fabric_errors();
  const auto q = static_cast<Eigen::Index>(parameter_index("fabric_max.Q_c"));
  c.covariance.row(q).setZero();
  c.covariance.col(q).setZero();
  EXPECT_TRUE(std::isnan(standard_error(c, curve_named("fabric_max"), 0.7)));
  EXPECT_TRUE(std::isnan(standard_error(c, curve_named("C_star"), 0.7)));
}

}  // namespace
}  // namespace grainlaw
