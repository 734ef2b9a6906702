#include "chain/studies/study_quantity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/student.hpp"

namespace grainlaw::chain {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// The mean of packings with values `x`.
StudyQuantity mean_of(const RowVectorXd& x) {
  const double n = static_cast<double>(x.size());
  return {"x", VectorXd::Constant(1, x.mean()), (x.array() - x.mean()) / std::sqrt(n * (n - 1)), true};
}

TEST(StudyQuantity, CommonPackingsArePaired) {
  const RowVectorXd r{{2.0, 2.5, 1.9, 2.2}}, x{{2.1, 2.7, 1.9, 2.3}}, d = (x - r) / r.mean();
  const QuantityError e = compare(mean_of(x), {1, 2, 3, 4}, mean_of(r), {1, 2, 3, 4});
  const double se = std::sqrt((d.array() - d.mean()).square().sum() / (4 * 3));
  EXPECT_NEAR(e.error, d.mean(), 1e-14);
  EXPECT_NEAR(e.standard_error, se, 1e-14);
  EXPECT_NEAR(e.half_width, student_95(3) * se, 1e-14);
  EXPECT_NEAR(e.sampling, student_95(3) * mean_of(x).influence.norm() / r.mean(), 1e-14);
  EXPECT_DOUBLE_EQ(e.value, x.mean());
}

TEST(StudyQuantity, TheOrderOfPackingsIsThatOfTheirSeeds) {
  const RowVectorXd r{{2.0, 2.5, 1.9}}, x{{1.9, 2.0, 2.5}};
  EXPECT_NEAR(compare(mean_of(x), {3, 1, 2}, mean_of(r), {1, 2, 3}).standard_error, 0, 1e-14);
  EXPECT_GT(compare(mean_of(x), {1, 2, 3}, mean_of(r), {1, 2, 3}).standard_error, 0.05);
}

TEST(StudyQuantity, OtherPackingsAddTheirVariance) {
  const StudyQuantity ours = mean_of(RowVectorXd{{2.0, 2.4}}), reference = mean_of(RowVectorXd{{2.0, 2.4, 2.2, 1.8}});
  const double largest = reference.values(0);
  const QuantityError apart = compare(ours, {7, 8}, reference, {1, 2, 3, 4});
  EXPECT_NEAR(apart.standard_error, std::hypot(ours.influence.norm(), reference.influence.norm()) / largest, 1e-14);
  // two of the four: what is common to both cancels
  const QuantityError nested = compare(ours, {1, 2}, reference, {1, 2, 3, 4});
  const double common = (ours.influence - reference.influence.leftCols(2)).squaredNorm();
  EXPECT_NEAR(nested.standard_error, std::sqrt(common + reference.influence.rightCols(2).squaredNorm()) / largest,
              1e-14);
  EXPECT_LT(nested.standard_error, apart.standard_error);
  EXPECT_NEAR(nested.half_width, student_95(1) * nested.standard_error, 1e-14);
}

TEST(StudyQuantity, ACurveIsJudgedByItsRootMeanSquareOverTheLargestValue) {
  const StudyQuantity reference{"P_star", VectorXd{{1, 2, 4}}, MatrixXd::Zero(3, 2), true};
  const StudyQuantity ours{"P_star", VectorXd{{1, 1.6, 4.3}}, MatrixXd{{0, 0}, {0.3, 0.4}, {0.1, 0.1}}, true};
  const QuantityError e = compare(ours, {1, 2}, reference, {1, 2});
  EXPECT_NEAR(e.error, std::sqrt((0.16 + 0.09) / 3) / 4, 1e-14);
  EXPECT_NEAR(e.standard_error, std::sqrt((0.25 + 0.02) / 3) / 4, 1e-14);
  EXPECT_EQ(e.value, 4.3);
}

TEST(StudyQuantity, WhatOneOfThemDoesNotShowIsMissing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const StudyQuantity shown = mean_of(RowVectorXd{{1, 2}}),
                      missing{"x", VectorXd::Constant(1, nan), MatrixXd::Zero(1, 2)};
  EXPECT_TRUE(std::isnan(compare(missing, {1, 2}, shown, {1, 2}).error));
  EXPECT_TRUE(std::isnan(compare(shown, {1, 2}, missing, {1, 2}).error));
  EXPECT_TRUE(std::isnan(compare({}, {1, 2}, shown, {1, 2}).error));
  const StudyQuantity curve{"x", VectorXd{{1, nan, 2}}, MatrixXd::Zero(3, 2)},
      ours{"x", VectorXd{{2, 1, 2}}, MatrixXd::Zero(3, 2)};
  EXPECT_NEAR(compare(ours, {1, 2}, curve, {1, 2}).error, 0.5 / std::sqrt(2.0), 1e-14);
}

}  // namespace
}  // namespace grainlaw::chain
