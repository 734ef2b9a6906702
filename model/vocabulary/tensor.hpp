#pragma once
// Symmetric second-rank tensors of the element test and their invariants.
//
//   |a|_dev = sqrt(((axx-ayy)^2+(ayy-azz)^2+(azz-axx)^2)/2 + 3(axy^2+ayz^2+axz^2)) = sqrt(3 J2)   Eqs. (4), (8), (10)
//   <a,b>   = (3/2) a':b'            so that <a,a> = |a|_dev^2  (a' the deviator)
//
// A deviator is kept as the 5-vector q in which <a,b> is the plain dot product:
//   q = ((2 azz-axx-ayy)/2, sqrt(3)/2 (axx-ayy), sqrt(3) ayz, sqrt(3) axz, sqrt(3) axy).
// Signs: strain and strain rate are tension positive, stress is compression positive (docs/conventions.md).
// Order of components wherever six numbers are listed: xx yy zz yz xz xy.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

namespace grainlaw {

template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// Deviator in the coordinates above: a.dot(b) = <a,b>, a.norm() = |a|_dev.
template <class T>
using Deviator = Eigen::Matrix<T, 5, 1>;

// clang-format off
struct Strain     { Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero(); };  ///< logarithmic strain, tension positive [-]
struct StrainRate { Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero(); };  ///< rate of strain or its direction, tension positive [1/s or -]
struct Stress     { Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero(); };  ///< Cauchy stress, compression positive [Pa]
struct Fabric     { Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero(); };  ///< fabric tensor, Eq. (9) [-]
// clang-format on

inline constexpr std::array<std::array<int, 2>, 6> kComponentIndex{{{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};
inline constexpr std::array<const char*, 6> kComponentName{"xx", "yy", "zz", "yz", "xz", "xy"};

/// Coordinates of the deviatoric part of the symmetric tensor `a` (its antisymmetric part is ignored).
template <class T>
Deviator<T> deviator(const Matrix3<T>& a) {
  const double h = std::numbers::sqrt3 / 2;
  Deviator<T> q;
  q << (2.0 * a(2, 2) - a(0, 0) - a(1, 1)) / 2.0, h * (a(0, 0) - a(1, 1)), h * (a(1, 2) + a(2, 1)), h * (a(0, 2) + a(2, 0)),
      h * (a(0, 1) + a(1, 0));
  return q;
}

/// The traceless symmetric tensor with the coordinates `q`.
template <class T>
Matrix3<T> tensor_of(const Deviator<T>& q) {
  const double r = 1 / std::numbers::sqrt3;
  Matrix3<T> a;
  const T xx = -q(0) / 3.0 + r * q(1), yy = -q(0) / 3.0 - r * q(1), zz = q(0) * (2.0 / 3.0);
  a << xx, r * q(4), r * q(3), r * q(4), yy, r * q(2), r * q(3), r * q(2), zz;
  return a;
}

/// |a|_dev = sqrt(3 J2), Eqs. (4), (8), (10).
inline double deviatoric_norm(const Eigen::Matrix3d& a) { return deviator<double>(a).norm(); }

/// Shape factor Lambda = d2/d1 of the deviator's eigenvalues sorted descending; NaN without deviator (Table 1).
/// Give tension-positive tensors (negate stress and fabric).
double shape_factor(const Eigen::Matrix3d& a);

/// Lode angle theta = acos((3 sqrt3/2) J3/J2^(3/2))/3 in degrees, 0..60, NaN without deviator (Table 1:
/// D3 and UNI 60, D2 30, reversed 0). Give tension-positive tensors.
double lode_angle(const Eigen::Matrix3d& a, bool portable = false);

}  // namespace grainlaw
