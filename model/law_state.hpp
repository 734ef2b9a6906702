#pragma once
// State of the law, the direction in which a path drives it, and what a spin does to it. Compression positive,
// dimensionless (* dropped); deviators are the 5-vectors of tensor.hpp.
//   L = D + W:  dx = -tr D de,  N = -D'/|D|_dev,  W a = w x a
//   Jaumann:    da/dt = (da/dt)_law + W a - a W   for every deviator of the state

#include <Eigen/Geometry>
#include <cstddef>
#include <type_traits>

#include "model/vocabulary/path.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

/// T, but a plain number where T is a dual one: of what no parameter changes. The product of two dual numbers is three times the work.
template <class T>
using Plain = std::conditional_t<std::is_floating_point_v<T>, T, double>;

/// State of the law, or its rate: one vector (as_vector) whose parts have names. A part is a number or a deviator, zero unless
/// given; no parameter changes E. A new variable is a member here and its line in for_each_part().
template <class T>
struct LawState {
  T P{};                                    ///< pressure P* [-]
  Deviator<T> sigma = Deviator<T>::Zero();  ///< deviatoric stress times 2<r>/k, compression positive [-]
  Deviator<T> F = Deviator<T>::Zero();      ///< deviatoric fabric, compression positive [-]
  // read by Rung::memory alone, zero when virgin
  Deviator<T> s_r = Deviator<T>::Zero();              ///< sigma'/P at the last reversal [-]
  Deviator<Plain<T>> E = Deviator<Plain<T>>::Zero();  ///< fading memory of the direction of shear, |E| <= 1 [-]
};

/// What there is to say of a part.
struct StatePart {
  const char* name;  ///< for messages
  bool has_rate;     ///< false: only turns of the shear and spin change it
  double typical;    ///< magnitude in steady shear [-]
  bool of_P;         ///< `typical` is in units of P
};

/// The table of the parts: calls visit(StatePart, part of each of `states`) for one after the other.
template <class Visit, class... States>
void for_each_part(const Visit& visit, States&... states) {
  //               name      has_rate  typical  of_P
  visit(StatePart{"P*", true, 1, true}, states.P...);
  visit(StatePart{"sigma'*", true, 0.1, true}, states.sigma...);
  visit(StatePart{"F'", true, 0.1, false}, states.F...);
  visit(StatePart{"s_r", false, 0.1, false}, states.s_r...);
  visit(StatePart{"E", true, 0.1, false}, states.E...);
}

/// Numbers of a state.
inline constexpr std::size_t kStateSize = sizeof(LawState<double>) / sizeof(double);
template <class T>
using StateVector = Eigen::Matrix<T, static_cast<int>(kStateSize), 1>;

/// All numbers of `y`, in the order of the members.
template <class T>
Eigen::Map<StateVector<T>> as_vector(LawState<T>& y) {
  static_assert(sizeof(LawState<T>) == kStateSize * sizeof(T), "nothing but T in a state, without gaps");
  return Eigen::Map<StateVector<T>>(reinterpret_cast<T*>(&y));
}
template <class T>
Eigen::Map<const StateVector<T>> as_vector(const LawState<T>& y) {
  static_assert(sizeof(LawState<T>) == kStateSize * sizeof(T), "nothing but T in a state, without gaps");
  return Eigen::Map<const StateVector<T>>(reinterpret_cast<const T*>(&y));
}

/// Scalar conversion, e.g. to dual numbers with zero derivative.
template <class T>
LawState<T> cast(const LawState<double>& y) {
  LawState<T> converted;
  for_each_part(
      []<class From, class To>(const StatePart&, const From& from, To& to) {
        if constexpr (std::is_same_v<From, double>)
          to = To(from);
        else
          to = from.template cast<typename To::Scalar>();
      },
      y, converted);
  return converted;
}

/// a + c b.
template <class T>
LawState<T> moved(const LawState<T>& a, double c, const LawState<T>& b) {
  LawState<T> sum;
  as_vector(sum) = as_vector(a) + c * as_vector(b);
  return sum;
}

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

/// Of a segment of a given path, whose shear may be noise beside its volumetric strain: then it has none.
inline LawDirection path_direction(const Eigen::Matrix3d& L) {
  LawDirection direction = law_direction(L);
  if (!shears(StrainRate{L})) direction = {.dx = direction.dx, .spin = direction.spin};
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

/// `q` after rotation by the spin vector times `e`.
inline Deviator<double> rotated(const Deviator<double>& q, const Eigen::Vector3d& spin, double e) {
  const double angle = spin.norm() * e;
  if (angle == 0) return q;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, spin.normalized()).toRotationMatrix();
  return deviator<double>(Eigen::Matrix3d(R * tensor_of(q) * R.transpose()));
}

/// Adds the corotational terms of `direction` to the rate of `y`: of every deviator.
template <class T>
void add_corotation(const LawState<T>& y, const LawDirection& direction, LawState<T>& rate) {
  if (direction.spin.isZero(0)) return;
  for_each_part(
      [&direction]<class Part>(const StatePart&, const Part& of_y, Part& of_rate) {
        if constexpr (!std::is_same_v<Part, T>) of_rate += corotation(direction.spin, of_y);
      },
      y, rate);
}

}  // namespace grainlaw
