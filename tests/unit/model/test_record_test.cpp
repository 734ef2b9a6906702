#include "model/vocabulary/test_record.hpp"

#include <gtest/gtest.h>

#include <array>

namespace grainlaw {
namespace {

TestRecord test_of(std::vector<StrainRate> directions) {
  TestRecord test;
  test.path.nu = 0.7;
  for (const StrainRate& d : directions) test.path.segments.push_back({Mode::tensor, d, ExtentKind::eps_dev, 0.1});
  return test;
}

/// ISO loading, ISO unloading, pure shear.
std::array<bool, 3> kinds(const TestRecord& test) {
  return {is_isotropic_loading(test), is_isotropic_unloading(test), is_pure_shear(test)};
}

TEST(TestRecord, KindsOfSingleSegments) {
  using Kinds = std::array<bool, 3>;
  EXPECT_EQ(kinds(test_of({direction_of(Mode::ISO)})), (Kinds{true, false, false}));
  EXPECT_EQ(kinds(test_of({direction_of(Mode::ISO, "xyz", true)})), (Kinds{false, true, false}));
  EXPECT_EQ(kinds(test_of({direction_of(Mode::D2)})), (Kinds{false, false, true}));
  EXPECT_EQ(kinds(test_of({direction_of(Mode::D3, "zxy", true)})), (Kinds{false, false, true}));
  EXPECT_EQ(kinds(test_of({direction_of(Mode::UNI)})), (Kinds{false, false, false}));
  EXPECT_EQ(kinds(test_of({StrainRate{}})), (Kinds{false, false, false})) << "no motion at all";
  StrainRate simple_shear;
  simple_shear.tensor(0, 1) = simple_shear.tensor(1, 0) = 0.5;
  EXPECT_EQ(kinds(test_of({simple_shear})), (Kinds{false, false, true}));
}

TEST(TestRecord, SequencesAreNoneOfThem) {
  for (const auto& test : {test_of({}), test_of({direction_of(Mode::D2), direction_of(Mode::ISO)}),
                           test_of({direction_of(Mode::D2), direction_of(Mode::D2)})}) {
    EXPECT_EQ(kinds(test), (std::array<bool, 3>{false, false, false}));
  }
}

TEST(TestRecord, StressUnitIsStiffnessOverMeanDiameter) {
  // 1e8 kg/s^2 over 2 mm
  EXPECT_NEAR((PackingInfo{1, 9261, 3, 1e-3, 1e8}.stress_unit()), 5e10, 1e-4);
}

TEST(TestRecord, RoleNames) {
  EXPECT_EQ(to_string(Role::calibration), "calibration");
  EXPECT_EQ(to_string(Role::validation), "validation");
}

}  // namespace
}  // namespace grainlaw
