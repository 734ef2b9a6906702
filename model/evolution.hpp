#pragma once
// Eq. (16), the coupled evolution of pressure, deviatoric stress and fabric, in tensor form. Compression positive,
// dimensionless (* dropped), <a,b> = (3/2) a:b, per unit of the path parameter e (strain is the independent variable):
//   dP      = B dx + A1 S de,                                  S  = 1 - <sigma',N>/(P s_max)
//   dsigma' = a2 B F' dx + DG (N - sigma'/(P s_max)) de,       DG = beta_s s_max P
//   dF'     = beta_F (F_max N - F') de
//   dx = -d eps_vol, de = |d eps'|, N = d eps'/de (compression positive); nu is a function of the path.
// Coupling::energy: A1 = (2/3)(a2 B <F',N> - <sigma',N>). Coupling::single: A1 = a0 <F',N>, A2 = (a0/3) F'.
// On monotone shear with A1 = 0 this is Eqs. (17) and (18) exactly.
// Templated on the scalar of the parameters and of the state; no solver's header in here.

#include "model/parameters.hpp"
#include "model/tensor.hpp"

namespace grainlaw {

/// State of the law, or its rate.
template <class T>
struct LawState {
  T P{};              ///< pressure P* [-]
  Deviator<T> sigma;  ///< deviatoric stress times 2<r>/k, compression positive [-]
  Deviator<T> F;      ///< deviatoric fabric, compression positive [-]
};

/// Direction of a straight segment as the law needs it, per unit of the path parameter.
struct LawDirection {
  double dx = 0;                                          ///< -tr D: volumetric compression [-]
  double de = 0;                                          ///< |D|_dev >= 0 [-]
  Deviator<double> N = Deviator<double>::Zero();          ///< -D'/|D|_dev, zero without shear [-]
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
  }
  return direction;
}

/// What the right-hand side takes from the volume fraction alone; worth keeping where that does not change.
template <class T>
struct LawModuli {
  T B{};       ///< bulk modulus B* [-]
  T s_max{};   ///< limit of the stress ratio [-]
  T beta_s{};  ///< its growth rate [-]
  T F_max{};   ///< limit of the deviatoric fabric [-]
  T beta_F{};  ///< its growth rate [-]
};

template <class T>
LawModuli<T> moduli_at(const LawParameters<T>& p, double nu) {
  return {p.isotropic.B_star(nu), p.stress_ratio_max.value(nu, p.shear_nu_c), p.stress_rate.value(nu, p.shear_nu_c),
          p.fabric_max.value(nu, p.shear_nu_c), p.fabric_rate.value(nu, p.shear_nu_c)};
}

/// Right-hand side of Eq. (16): d(state)/de with the moduli of the current volume fraction. Finite for P > 0 and finite
/// arguments.
template <class T>
LawState<T> evolution_rate(const LawModuli<T>& m, const Anisotropy<T>& anisotropy, Coupling coupling,
                           const LawState<T>& y, const LawDirection& direction) {
  const Deviator<T> N = direction.N.template cast<T>();
  const T sigma_N = y.sigma.dot(N);
  const T F_N = y.F.dot(N);
  T A1, A2_per_F;
  if (coupling == Coupling::single) {
    A1 = anisotropy.a0 * F_N;
    A2_per_F = anisotropy.a0 / 3.0;
  } else {
    A2_per_F = anisotropy.a2 * m.B;
    A1 = (2.0 / 3.0) * (A2_per_F * F_N - sigma_N);
  }
  const T S = 1.0 - sigma_N / (y.P * m.s_max);
  LawState<T> rate;
  rate.P = m.B * direction.dx + A1 * S * direction.de;
  rate.sigma =
      y.F * (A2_per_F * direction.dx) + (N * (m.beta_s * m.s_max * y.P) - y.sigma * m.beta_s) * T(direction.de);
  rate.F = (N * m.F_max - y.F) * (m.beta_F * direction.de);
  return rate;
}

/// The same at volume fraction `nu`.
template <class T>
LawState<T> evolution_rate(const LawParameters<T>& p, Coupling coupling, const LawState<T>& y, double nu,
                           const LawDirection& direction) {
  return evolution_rate(moduli_at(p, nu), p.anisotropy, coupling, y, direction);
}

}  // namespace grainlaw
