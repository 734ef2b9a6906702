#include "fit/describe.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/vocabulary/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

const LawParameters<double> kDescribed = testing::synthetic_truth();

std::vector<TestRecord> records_to_describe() {
  testing::SyntheticOptions options;
  options.densities = {0.69, 0.72, 0.76, 0.81};
  testing::SyntheticDataset dataset(kDescribed, options);
  std::vector<TestRecord> tests;
  for (const std::uint64_t seed : options.seeds) {
    tests.push_back(dataset.test(fmt::format("uni-s{}", seed), seed, 0.68,
                                 {testing::synthetic_segment(Mode::UNI, ExtentKind::target_nu, 0.82),
                                  testing::synthetic_segment(Mode::UNI, ExtentKind::target_nu, 0.68, true)}));
    for (const double nu : options.densities) {
      for (const Mode mode : {Mode::D2, Mode::D3}) {
        tests.push_back(dataset.test(fmt::format("{}-{:.2f}-s{}", to_string(mode), nu, seed), seed, nu,
                                     {testing::synthetic_segment(mode, ExtentKind::eps_dev, 0.30)}));
        if (mode == Mode::D2) tests.back().path.branch = Branch::loading;
      }
    }
  }
  for (TestRecord& test : tests) test.role = Role::description;
  return tests;
}

std::vector<Description> described(const std::vector<TestRecord>& tests) {
  return describe(tests, kDescribed.isotropic.pressure.nu_c, {}, {});
}

TEST(Describe, NamesTheModesThatTheTestsContain) {
  std::vector<std::string> names;
  for (const Description& d : described(records_to_describe())) names.push_back(d.name);
  EXPECT_EQ(names, (std::vector<std::string>{"UNI", "D2-loading", "D3"}));

  std::vector<TestRecord> tests = records_to_describe();
  std::erase_if(tests, [](const TestRecord& test) { return !test.name.starts_with("D3"); });
  ASSERT_EQ(described(tests).size(), 1u);
  EXPECT_TRUE(described({}).empty());
}

// The synthetic UNI rows carry C* and phi_r of the steady law: the description of UNI must find that one, from the rows of
// unloading alone.
TEST(Describe, UniaxialLawsComeFromTheUnloadingSegment) {
  std::vector<TestRecord> tests = records_to_describe();
  for (TestRecord& test : tests) {
    if (!test.name.starts_with("uni")) continue;
    for (Observation& row : test.rows) {
      if (row.segment != 0) continue;
      row.C_star += 0.3;  // loading must not matter
      row.C = (1 - row.rattler_fraction) * row.C_star;
    }
  }
  const std::vector<Description> all = described(tests);
  const Calibration& uni = all.front().calibration;
  EXPECT_NEAR(uni.law.parameters.isotropic.coordination.C1, kDescribed.steady.coordination.C1, 1e-6);
  EXPECT_NEAR(uni.law.parameters.isotropic.coordination.nu_c, kDescribed.steady.coordination.nu_c, 1e-8);
  EXPECT_TRUE(has_values(uni.law, "pressure"));
  EXPECT_FALSE(has_values(uni.law, "stress_ratio_max"));
}

TEST(Describe, ShearModesGiveTheLawsOverDensity) {
  for (const Description& d : described(records_to_describe())) {
    if (d.name == "UNI") continue;
    const LawParameters<double>& p = d.calibration.law.parameters;
    EXPECT_EQ(d.calibration.shear.size(), 8u) << d.name;
    for (const double nu : {0.70, 0.80}) {
      EXPECT_NEAR(p.fabric_max.value(nu, p.shear_nu_c) / kDescribed.fabric_max.value(nu, kDescribed.shear_nu_c), 1,
                  2e-3)
          << d.name;
      EXPECT_NEAR(p.steady.coordination.C_star(nu), kDescribed.steady.coordination.C_star(nu), 1e-6) << d.name;
    }
    EXPECT_FALSE(has_values(d.calibration.law, "pressure")) << d.name;
    EXPECT_TRUE(d.calibration.law.converged);
  }
}

TEST(Describe, TakesNoTestsOfAnotherRole) {
  std::vector<TestRecord> tests = records_to_describe();
  tests.front().role = Role::calibration;
  EXPECT_THROW(described(tests), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::fit
