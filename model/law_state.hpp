#pragma once
// State of the law, the direction in which a path drives it, and what a spin does to it. Compression positive,
// dimensionless (* dropped); deviators are the 5-vectors of tensor.hpp.
//   L = D + W:  dx = -tr D de,  N = -D'/|D|_dev,  W a = w x a
//   Jaumann:    da/dt = (da/dt)_law + W a - a W   for sigma', F', s_r and E

#include <Eigen/Geometry>

#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

/// State of the law, or its rate.
template <class T>
struct LawState {
  T P{};                                  ///< pressure P* [-]
  Deviator<T> sigma;                      ///< deviatoric stress times 2<r>/k, compression positive [-]
  Deviator<T> F;                          ///< deviatoric fabric, compression positive [-]
  Deviator<T> s_r = Deviator<T>::Zero();  ///< sigma'/P at the last reversal, zero when virgin; read by Rung::memory [-]
  Deviator<T> E = Deviator<T>::Zero();    ///< fading memory of the direction of shear, |E| <= 1, zero when virgin; read by Rung::memory [-]
};

/// Direction of a straight segment as the law needs it, per unit of the path parameter.
struct LawDirection {
  double dx = 0;                                   ///< -tr D: volumetric compression [-]
  double de = 0;                                   ///< |D|_dev >= 0 [-]
  Deviator<double> N = Deviator<double>::Zero();   ///< -D'/|D|_dev, zero without shear [-]
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();  ///< w, the axial vector of W [rad per unit of the path parameter]
  double lode = 0;  ///< l = -cos 3 theta, theta the Lode angle of D: 0 in D2, 1 in D3 and UNI, -1 in their reverse [-]
};

/// From a strain-rate direction (tension positive).
inline LawDirection law_direction(const StrainRate& rate) {
  LawDirection direction;
  direction.dx = -rate.tensor.trace();
  const Deviator<double> d = -deviator<double>(rate.tensor);
  const double norm = d.norm();
  if (norm > 1e-12 * rate.tensor.norm()) {
    direction.de = norm;
    direction.N = d / norm;
    direction.lode = 13.5 * tensor_of(direction.N).determinant();  // J3, where J2 = 1/3
  }
  return direction;
}

/// From a velocity gradient L, dx_i/dt = L_ij x_j (tension positive).
inline LawDirection law_direction(const Eigen::Matrix3d& L) {
  LawDirection direction = law_direction(StrainRate{0.5 * (L + L.transpose())});
  direction.spin << (L(2, 1) - L(1, 2)) / 2, (L(0, 2) - L(2, 0)) / 2, (L(1, 0) - L(0, 1)) / 2;
  return direction;
}

/// W a - a W of the deviator `q`.
template <class T>
Deviator<T> corotation(const Eigen::Vector3d& spin, const Deviator<T>& q) {
  const Matrix3<T> a = tensor_of(q);
  Matrix3<T> W;
  W << T(0), T(-spin(2)), T(spin(1)), T(spin(2)), T(0), T(-spin(0)), T(-spin(1)), T(spin(0)), T(0);
  return deviator<T>(Matrix3<T>(W * a - a * W));
}

/// Adds the corotational terms of `direction` to the rate of `y`.
template <class T>
void add_corotation(const LawState<T>& y, const LawDirection& direction, LawState<T>& rate) {
  if (direction.spin.isZero(0)) return;
  rate.sigma += corotation(direction.spin, y.sigma);
  rate.F += corotation(direction.spin, y.F);
  rate.s_r += corotation(direction.spin, y.s_r);
  rate.E += corotation(direction.spin, y.E);
}

}  // namespace grainlaw
