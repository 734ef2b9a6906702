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

}  // namespace
}  // namespace grainlaw
