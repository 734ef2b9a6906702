#include "model/vocabulary/tensor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>

namespace grainlaw {
namespace {

using Eigen::Matrix3d;

Matrix3d symmetric(double xx, double yy, double zz, double yz, double xz, double xy) {
  Matrix3d a;
  a << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return a;
}

const Matrix3d kA = symmetric(1.3, -0.4, 2.2, 0.7, -1.1, 0.25);
const Matrix3d kB = symmetric(-0.6, 0.9, 0.35, -0.2, 0.45, 1.7);
const Matrix3d kRotation = Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();

Matrix3d traceless(const Matrix3d& a) { return a - a.trace() / 3 * Matrix3d::Identity(); }

Matrix3d diagonal(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }

TEST(Tensor, DotProductOfCoordinatesIsThreeHalvesOfTheContraction) {
  const double expected = 1.5 * traceless(kA).cwiseProduct(traceless(kB)).sum();
  EXPECT_NEAR(deviator<double>(kA).dot(deviator<double>(kB)), expected, 1e-14);
}

TEST(Tensor, NormIsTheOneOfThePaper) {
  const double expected = std::sqrt((std::pow(1.3 + 0.4, 2) + std::pow(-0.4 - 2.2, 2) + std::pow(2.2 - 1.3, 2)) / 2 +
                                    3 * (0.7 * 0.7 + 1.1 * 1.1 + 0.25 * 0.25));
  EXPECT_NEAR(deviatoric_norm(kA), expected, 1e-14);
  const double J2 = 0.5 * traceless(kA).squaredNorm();
  EXPECT_NEAR(deviatoric_norm(kA), std::sqrt(3 * J2), 1e-14);
}

TEST(Tensor, UniaxialStressHasItsVonMisesValue) { EXPECT_NEAR(deviatoric_norm(diagonal(0, 0, 2)), 2, 1e-15); }

TEST(Tensor, CoordinatesAndTensorAreInverse) {
  EXPECT_LE((tensor_of(deviator<double>(kA)) - traceless(kA)).norm(), 1e-15 * kA.norm());
  Deviator<double> q;
  q << 0.3, -1.2, 0.8, 2.1, -0.5;
  EXPECT_LE((deviator<double>(tensor_of(q)) - q).norm(), 1e-15 * q.norm());
  EXPECT_NEAR(tensor_of(q).trace(), 0, 1e-15);
}

TEST(Tensor, AntisymmetricPartIsIgnored) {
  Matrix3d spin;
  spin << 0, 1, -2, -1, 0, 3, 2, -3, 0;
  EXPECT_LE((deviator<double>(Matrix3d(kA + spin)) - deviator<double>(kA)).norm(), 1e-14);
}

TEST(Tensor, IsotropicTensorHasNoDeviator) { EXPECT_EQ(deviatoric_norm(diagonal(0.7, 0.7, 0.7)), 0); }

TEST(Tensor, InvariantsDoNotDependOnTheFrame) {
  const Matrix3d turned = kRotation * kA * kRotation.transpose();
  EXPECT_NEAR(deviatoric_norm(turned), deviatoric_norm(kA), 1e-14);
  EXPECT_NEAR(shape_factor(turned), shape_factor(kA), 1e-13);
  EXPECT_NEAR(lode_angle(turned), lode_angle(kA), 1e-11);
}

TEST(Tensor, Table1) {
  struct Expected {
    const char* mode;
    Matrix3d rate;
    double norm, shape, lode, lode_reversed;
  };
  const Expected rows[] = {{"UNI", diagonal(0, 0, -1), 1, 1, 60, 0},
                           {"D2", diagonal(1, 0, -1), std::sqrt(3.0), 0, 30, 30},
                           {"D3", diagonal(0.5, 0.5, -1), 1.5, 1, 60, 0}};
  for (const Expected& row : rows) {
    EXPECT_NEAR(deviatoric_norm(row.rate), row.norm, 1e-15) << row.mode;
    EXPECT_NEAR(shape_factor(row.rate), row.shape, 1e-14) << row.mode;
    EXPECT_NEAR(lode_angle(row.rate), row.lode, 1e-5) << row.mode;
    EXPECT_NEAR(lode_angle(-row.rate), row.lode_reversed, 1e-5) << row.mode;
  }
  EXPECT_NEAR(shape_factor(diagonal(0, 0, 1)), -0.5, 1e-14) << "reversed UNI";
  EXPECT_NEAR(shape_factor(diagonal(-0.5, -0.5, 1)), -0.5, 1e-14) << "reversed D3";
}

TEST(Tensor, ShapeAndLodeAngleAreUndefinedWithoutADeviator) {
  for (const Matrix3d& a : {Matrix3d(Matrix3d::Zero()), diagonal(-1, -1, -1), diagonal(0.1, 0.1, 0.1 + 1e-17)}) {
    EXPECT_TRUE(std::isnan(shape_factor(a)));
    EXPECT_TRUE(std::isnan(lode_angle(a)));
  }
}

TEST(Tensor, ComponentOrderIsXxYyZzYzXzXy) {
  const Matrix3d a = symmetric(0, 1, 2, 3, 4, 5);
  const double expected[] = {0, 1, 2, 3, 4, 5};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto [row, column] = kComponentIndex[i];
    EXPECT_EQ(a(row, column), expected[i]);
    const std::string name{static_cast<char>('x' + row), static_cast<char>('x' + column)};
    EXPECT_EQ(name, kComponentName[i]);
  }
}

}  // namespace
}  // namespace grainlaw
