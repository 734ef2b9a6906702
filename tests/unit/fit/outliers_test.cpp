#include "fit/data/outliers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

using Numbers = std::vector<std::size_t>;

std::vector<double> saturating_curve(std::size_t rows) {
  std::vector<double> x;
  for (std::size_t i = 0; i < rows; ++i) x.push_back(0.15 * (1 - std::exp(-0.2 * static_cast<double>(i))));
  return x;
}

std::vector<double> noisy_curve(std::size_t rows, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, 0.002);
  std::vector<double> x = saturating_curve(rows);
  for (double& v : x) v += noise(engine);
  return x;
}

TEST(Outliers, AreFoundWhereTheyWerePut) {
  std::vector<double> x = noisy_curve(60, 1);
  EXPECT_EQ(outliers_of(x, 0), Numbers{});
  x[20] += 0.1;
  x[37] -= 0.1;
  x[38] += 0.1;  // two in a row
  EXPECT_EQ(outliers_of(x, 0), (Numbers{20, 37, 38}));
}

TEST(Outliers, ANumberThatWasCutAtTheEndOfAFileIsFound) {
  std::vector<double> x = noisy_curve(24, 3);
  EXPECT_EQ(outliers_of(x, 0.05), Numbers{});
  x.back() = 1.5;
  EXPECT_EQ(outliers_of(x, 0.05), Numbers{23}) << "and not the row before it";
}

TEST(Outliers, NoneAreFoundInWhatIsSmoothSteepOrKinked) {
  EXPECT_EQ(outliers_of(saturating_curve(60), 0), Numbers{}) << "a curve without noise";
  std::vector<double> constant(60, 3.0), zigzag, jump;
  for (int i = 0; i < 60; ++i) {
    zigzag.push_back(std::abs(i - 30));
    jump.push_back(i < 30 ? 1 : 2);
  }
  EXPECT_EQ(outliers_of(constant, 0), Numbers{});
  EXPECT_EQ(outliers_of(zigzag, 0), Numbers{}) << "a reversal";
  EXPECT_EQ(outliers_of(jump, 0), Numbers{}) << "a jump is no outlier: both sides have company";
  jump.back() = 1;
  EXPECT_EQ(outliers_of(jump, 0), Numbers{}) << "nor one into the last row that is no larger: it may have company";
}

TEST(Outliers, OneInAConstantSeriesIsFound) {
  std::vector<double> x(60, 3.0);
  x[11] = 3.0 + 1e-6;
  EXPECT_EQ(outliers_of(x, 0), Numbers{11});
}

TEST(Outliers, WhatIsTooSmallToMatterIsNot) {
  std::vector<double> x(60, 3.0);
  x[11] = 3.04;
  x[40] = 3.06;
  EXPECT_EQ(outliers_of(x, 0.05), Numbers{40});
}

/// ISO unloading of three packings, the P* of the second times `factor`.
std::vector<std::string> warnings_where_one_differs(double factor) {
  std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), {{0.70}, {1, 2, 3}});
  DataSet data;
  for (TestRecord& test : tests) {
    if (!is_isotropic_unloading(test)) continue;
    if (test.packing.seed == 2) {
      for (Observation& row : test.rows) row.P_star *= factor;
    }
    data.isotropic.push_back(&test);
  }
  return packing_warnings(data);
}

TEST(Outliers, APackingInOtherUnitsIsFound) {
  EXPECT_TRUE(warnings_where_one_differs(1.1).empty()) << "packings differ";
  for (const double factor : {2.0, 0.5, 10.0}) {
    const std::vector<std::string> said = warnings_where_one_differs(factor);
    ASSERT_EQ(said.size(), 1u) << factor;
    EXPECT_NE(said[0].find("-s2"), std::string::npos) << said[0];
    EXPECT_NE(said[0].find("mean_radius"), std::string::npos) << said[0];
  }
  EXPECT_TRUE(packing_warnings({}).empty());
}

TEST(Outliers, ShortSeriesAreNotJudged) {
  EXPECT_EQ(outliers_of({}, 0), Numbers{});
  EXPECT_EQ(outliers_of({1, 1, 1, 9, 1, 1, 1}, 0), Numbers{});
}

TEST(Outliers, WhiteNoiseAloneIsHardlyEverFlagged) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  std::size_t flagged = 0;
  for (int series = 0; series < 2000; ++series) {
    std::vector<double> x(61);
    for (double& v : x) v = normal(engine);
    flagged += outliers_of(x, 0).size();
  }
  EXPECT_LE(flagged, 12U) << "one of 1e4 rows";
}

}  // namespace
}  // namespace grainlaw::fit
