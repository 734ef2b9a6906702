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

/// Right-hand side of Eq. (16): d(state)/de at volume fraction `nu`. Finite for P > 0 and finite arguments.
template <class T>
LawState<T> evolution_rate(const LawParameters<T>& p, Coupling coupling, const LawState<T>& y, double nu,
                           const LawDirection& direction) {
  const T B = p.isotropic.B_star(nu);
  const T s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const T beta_s = p.stress_rate.value(nu, p.shear_nu_c);
  const T F_max = p.fabric_max.value(nu, p.shear_nu_c);
  const T beta_F = p.fabric_rate.value(nu, p.shear_nu_c);
  const Deviator<T> N = direction.N.template cast<T>();
  const T sigma_N = y.sigma.dot(N);
  const T F_N = y.F.dot(N);
  T A1, A2_per_F;
  if (coupling == Coupling::single) {
    A1 = p.anisotropy.a0 * F_N;
    A2_per_F = p.anisotropy.a0 / 3.0;
  } else {
    A2_per_F = p.anisotropy.a2 * B;
    A1 = (2.0 / 3.0) * (A2_per_F * F_N - sigma_N);
  }
  const T S = 1.0 - sigma_N / (y.P * s_max);
  LawState<T> rate;
  rate.P = B * direction.dx + A1 * S * direction.de;
  rate.sigma = y.F * (A2_per_F * direction.dx) + (N * (beta_s * s_max * y.P) - y.sigma * beta_s) * T(direction.de);
  rate.F = (N * F_max - y.F) * (beta_F * direction.de);
  return rate;
}

}  // namespace grainlaw
