#pragma once
// What depends on the volume fraction alone.
//   C*(nu)    = C0 + C1 (nu/nu_c - 1)^alpha, C0 = 6                                     Eq. (11)
//   phi_r(nu) = phi_c exp(-phi_v (nu/nu_c - 1)), nu_c the one of Eq. (11)               Eq. (12)
//   C         = (1 - phi_r) C*
//   P*(nu)    = p0 (nu C/nu_c) x (1 - gamma_p x), x = ln(nu/nu_c), nu_c the pressure's  Eq. (14)
//   B*(nu)    = dP*/dx, the bulk modulus of the law (compression positive)              derivative of (14)
//   Q(nu)     = Q_limit + Q_c exp(-alpha (nu/nu_c - 1))                                 Eq. (20)
// Below jamming: C* = C0, P* = 0, B* = 0. All quantities dimensionless (* = times 2<r>/k).
// Templated on the scalar because the fit takes derivatives through them.

#include <array>
#include <cmath>

namespace grainlaw {

inline constexpr double kIsostaticCoordination = 6;  ///< C0 of Eq. (11): frictionless spheres in three dimensions

template <class T>
struct Coordination {
  T C1{}, alpha{}, nu_c{};

  template <class N>
  auto C_star(const N& nu) const -> decltype(nu * C1) {
    using std::pow;
    const auto y = nu / nu_c - 1.0;
    if (!(y > 0.0)) return kIsostaticCoordination + 0.0 * y;
    return kIsostaticCoordination + C1 * pow(y, alpha);
  }
};

template <class T>
struct Rattlers {
  T phi_c{}, phi_v{};

  /// `nu_c` is Coordination::nu_c.
  template <class N>
  auto fraction(const N& nu, const T& nu_c) const -> decltype(nu * nu_c) {
    using std::exp;
    return phi_c * exp(-phi_v * (nu / nu_c - 1.0));
  }
};

template <class T>
struct Pressure {
  T p0{}, gamma_p{}, nu_c{};

  /// Eq. (15): P* nu_c/(nu C), zero below jamming.
  template <class N>
  auto scaled(const N& nu) const -> decltype(nu * p0) {
    using std::log;
    const auto x = log(nu / nu_c);
    if (!(x > 0.0)) return 0.0 * x;
    return p0 * x * (1.0 - gamma_p * x);
  }
};

/// Eq. (20).
template <class T>
struct ExponentialLaw {
  T Q_limit{}, Q_c{}, alpha{};

  template <class N>
  auto value(const N& nu, const T& nu_c) const -> decltype(nu * nu_c) {
    using std::exp;
    return Q_limit + Q_c * exp(-alpha * (nu / nu_c - 1.0));
  }
};

/// Eqs. (11), (12), (14) of one branch or mode: a row of Table 2.
template <class T>
struct StateLaw {
  Coordination<T> coordination;
  Rattlers<T> rattlers;
  Pressure<T> pressure;

  /// C = (1 - phi_r) C*
  template <class N>
  auto C(const N& nu) const -> decltype(nu * coordination.nu_c) {
    return (1.0 - rattlers.fraction(nu, coordination.nu_c)) * coordination.C_star(nu);
  }

  template <class N>
  auto P_star(const N& nu) const -> decltype(nu * coordination.nu_c) {
    return pressure.scaled(nu) * nu * C(nu) / pressure.nu_c;
  }

  /// P* and B* = dP*/dx = (p0 X/nu_c) {1 - 2 gamma_p x + x (1 - gamma_p x) [1 + dlnC/dlnnu]}, X = nu C, which share
  /// their logarithm, exponential and power: right-hand sides need both.
  template <class N>
  auto P_and_B(const N& nu) const -> std::array<decltype(nu * coordination.nu_c), 2> {
    using std::log;
    const auto x = log(nu / pressure.nu_c);
    if (!(x > 0.0)) return {0.0 * x, 0.0 * x};
    const auto y = nu / coordination.nu_c - 1.0;
    const auto phi_r = rattlers.fraction(nu, coordination.nu_c);
    const auto C_star = coordination.C_star(nu);
    auto dlnC = rattlers.phi_v * (1.0 + y) * phi_r / (1.0 - phi_r);
    if (y > 0.0) {
      // C1 alpha y^(alpha-1) = alpha (C* - C0)/y
      dlnC = dlnC + coordination.alpha * (C_star - kIsostaticCoordination) / y * (1.0 + y) / C_star;
    }
    const auto& g = pressure.gamma_p;
    const auto unit = pressure.p0 * nu * ((1.0 - phi_r) * C_star) / pressure.nu_c;
    return {unit * x * (1.0 - g * x), unit * (1.0 - 2.0 * g * x + x * (1.0 - g * x) * (1.0 + dlnC))};
  }

  template <class N>
  auto B_star(const N& nu) const -> decltype(nu * coordination.nu_c) {
    return P_and_B(nu)[1];
  }
};

}  // namespace grainlaw
