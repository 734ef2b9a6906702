#include "fit/data/density_series.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/data/shear_rows.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

std::vector<TestRecord> records(double shear_strain = 0.30) {
  testing::SyntheticOptions options;
  options.densities = {0.70, 0.74};
  options.sequences = false;
  options.shear_strain = shear_strain;
  options.rows = 60;
  return testing::synthetic_dataset(testing::synthetic_truth(), options);
}

TEST(DensitySeries, IsotropicRowsAreThoseOfTheWindow) {
  const std::vector<TestRecord> tests = records();
  const std::vector<DensitySeries> series = isotropic_series(check_and_sort(tests), {});
  ASSERT_EQ(series.size(), 2u);
  for (const DensitySeries& s : series) {
    EXPECT_EQ(s.points.size() + static_cast<std::size_t>(s.excluded), 61u);
    for (const DensityPoint& p : s.points) {
      EXPECT_GE(p.nu, 0.675);
      EXPECT_NEAR(p.C(), (1 - p.rattler_fraction) * p.C_star, 1e-15);
    }
  }
  EXPECT_GE(least_nu(series), 0.675);
  EXPECT_NE(series[0].cluster, series[1].cluster);
}

TEST(DensitySeries, SteadyPointIsTheMeanFromSteadyStrainOn) {
  std::vector<TestRecord> tests = records();
  for (TestRecord& test : tests) {
    if (!is_pure_shear(test)) continue;
    for (Observation& row : test.rows) {
      row.C_star = row.eps_dev < 0.15 - 1e-9 ? 6 : 7 + row.eps_dev;  // linear there
      row.C = (1 - row.rattler_fraction) * row.C_star;
    }
  }
  const std::vector<DensitySeries> series = steady_series(check_and_sort(tests), Mode::D2, {});
  ASSERT_EQ(series.size(), 4u);
  for (const DensitySeries& s : series) {
    ASSERT_EQ(s.points.size(), 1u);
    EXPECT_NEAR(s.points[0].C_star, 7 + (0.15 + 0.30) / 2, 1e-12);
    EXPECT_EQ(s.excluded, 30);
  }
}

// The steady state of the law is that of shear like D2, whatever the test calls it; a D3 test gives no point.
TEST(DensitySeries, SteadyPointsComeFromShearLikeD2Alone) {
  std::vector<TestRecord> tests = records();
  tests.push_back(testing::SyntheticDataset(testing::synthetic_truth(), {})
                      .test("d3", 1, 0.70, {testing::synthetic_segment(Mode::D3, ExtentKind::eps_dev, 0.30)}));
  for (TestRecord& test : tests)
    if (test.name != "d3" && is_pure_shear(test)) test.path.segments.front().mode = Mode::tensor;
  const DataSet data = check_and_sort(tests);
  EXPECT_EQ(data.pure_shear.size(), 5u);
  const std::vector<DensitySeries> series = steady_series(data, Mode::D2, {});
  EXPECT_EQ(series.size(), 4u);
  for (const DensitySeries& s : series) EXPECT_NE(s.test, "d3");
}

TEST(DensitySeries, TestsThatEndEarlyHaveNoSteadyPoint) {
  const std::vector<TestRecord> tests = records(0.10);
  EXPECT_TRUE(steady_series(check_and_sort(tests), Mode::D2, {}).empty());
}

TEST(DensitySeries, MissingCoordinationOfAJammedRowIsNamed) {
  std::vector<TestRecord> tests = records();
  tests[0].rows[7].C_star = std::nan("");
  try {
    isotropic_series(check_and_sort(tests), {});
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(tests[0].name), std::string::npos) << message;
    EXPECT_NE(message.find("row 8, column C_star"), std::string::npos) << message;
  }
}

TEST(DensitySeries, UnjammedRowsLeaveAndNeedNoCoordination) {
  std::vector<TestRecord> tests = records();
  Observation& row = tests[0].rows[7];
  row.C_star = std::nan("");
  row.stress.tensor.setZero();
  row.P_star = 0;
  EXPECT_FALSE(is_jammed(row));
  const std::vector<TestRecord> whole = records();
  EXPECT_EQ(isotropic_series(check_and_sort(tests), {})[0].excluded,
            isotropic_series(check_and_sort(whole), {})[0].excluded + 1);
}

TEST(DensitySeries, AWindowWithoutRowsIsRefused) {
  const std::vector<TestRecord> tests = records();
  CalibrationOptions options;
  options.iso_nu_min = 0.85;
  EXPECT_THROW(isotropic_series(check_and_sort(tests), options), InvalidInput);
}

TEST(DensitySeries, CountsDistinctDensities) {
  EXPECT_EQ(distinct_densities({}), 0);
  EXPECT_EQ(distinct_densities({0.70, 0.70, 0.7001}), 1);
  EXPECT_EQ(distinct_densities({0.74, 0.70, 0.68, 0.70}), 3);
}

}  // namespace
}  // namespace grainlaw::fit
