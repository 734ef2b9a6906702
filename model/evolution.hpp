#pragma once
// Eq. (16), the coupled evolution of pressure, deviatoric stress and fabric, in tensor form. Compression positive,
// dimensionless (* dropped), <a,b> = (3/2) a:b, per unit of the path parameter e (strain is the independent variable):
//   dP      = B dx + A1 S de,                                  S  = 1 - <sigma',N>/(P s_max)
//   dsigma' = a2 B F' dx + DG (N - sigma'/(P s_max)) de,       DG = beta_s s_max P
//   dF'     = beta_F (F_max N - F') de
// The limits of Eq. (20) are those of D2, l = 0; with l = -cos 3 theta, theta the Lode angle of the shear
// (docs/decisions/0005-memory-law.md), they are s_max (1 + psi_s l) and F_max (1 - psi_F l (nu/nu_c - 1)).
//   dx = -d eps_vol, de = |d eps'|, N = d eps'/de (compression positive); nu is a function of the path.
// Coupling::energy: A1 = (2/3)(a2 B <F',N> - <sigma',N>). Coupling::single: A1 = a0 <F',N>, A2 = (a0/3) F'.
// On monotone shear with A1 = 0 this is Eqs. (17) and (18) exactly.
// Templated on the scalar of the parameters and of the state; no solver's header in here.

#include "model/law_state.hpp"
#include "model/parameters.hpp"

namespace grainlaw {

/// What a right-hand side takes from the volume fraction alone; worth keeping where that does not change.
template <class T>
struct LawModuli {
  T P_iso{};   ///< pressure of ISO unloading, Eq. (14) [-]
  T B{};       ///< its derivative, the bulk modulus B* [-]
  T s_max{};   ///< limit of the stress ratio [-]
  T beta_s{};  ///< its growth rate [-]
  T F_max{};   ///< limit of the deviatoric fabric [-]
  T beta_F{};  ///< its growth rate [-]
  T F_fall{};  ///< fall of F_max from D2 to D3, relative [-]
  // of the memory rung only
  T nu{};        ///< volume fraction [-]
  T P_steady{};  ///< pressure of steady shear [-]
};

/// Fall of F_max from D2 to D3, relative [-]. Below one for nu < 1.
template <class T>
T fabric_fall(const LawParameters<T>& p, double nu) {
  return p.lode.fabric * (nu / p.shear_nu_c - 1.0);
}

/// Those of D2.
template <class T>
LawModuli<T> moduli_at(const LawParameters<T>& p, double nu) {
  LawModuli<T> m;
  const auto P_and_B = p.isotropic.P_and_B(nu);
  m.P_iso = P_and_B[0];
  m.B = P_and_B[1];
  m.s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  m.beta_s = p.stress_rate.value(nu, p.shear_nu_c);
  m.F_max = p.fabric_max.value(nu, p.shear_nu_c);
  m.beta_F = p.fabric_rate.value(nu, p.shear_nu_c);
  m.F_fall = fabric_fall(p, nu);
  return m;
}

/// `m` with the limits of shear along `direction`.
template <class T>
LawModuli<T> along(LawModuli<T> m, const LodeEffect<T>& lode, const LawDirection& direction) {
  m.s_max *= 1.0 + lode.stress_ratio * direction.lode;
  m.F_max *= 1.0 - m.F_fall * direction.lode;
  return m;
}

/// The moduli that couple the volumetric and the deviatoric part.
template <class T>
struct AnisotropyModuli {
  T A1{};        ///< of the pressure row, along N [-]
  T A2_per_F{};  ///< of the deviatoric row, dsigma' = A2_per_F F' dx [-]
};

template <class T>
AnisotropyModuli<T> anisotropy_moduli(const Anisotropy<T>& a, Coupling coupling, const T& B, const LawState<T>& y,
                                      const Deviator<Plain<T>>& N) {
  if (coupling == Coupling::single) return {a.a0 * y.F.dot(N), a.a0 / 3.0};
  const T A2_per_F = a.a2 * B;
  return {(2.0 / 3.0) * (A2_per_F * y.F.dot(N) - y.sigma.dot(N)), A2_per_F};
}

/// Right-hand side of Eq. (16) without corotational terms: d(state)/de with the moduli of the current volume fraction.
/// Finite for P > 0 and finite arguments. `m` with limits along `direction`.
template <class T>
LawState<T> evolution_rate(const LawModuli<T>& m, const Anisotropy<T>& anisotropy, Coupling coupling,
                           const LawState<T>& y, const LawDirection& direction) {
  const Deviator<Plain<T>> N = direction.N.template cast<Plain<T>>();
  const AnisotropyModuli<T> A = anisotropy_moduli(anisotropy, coupling, m.B, y, N);
  const T S = 1.0 - y.sigma.dot(N) / (y.P * m.s_max);
  LawState<T> rate;
  rate.P = m.B * direction.dx + A.A1 * S * direction.de;
  rate.sigma = y.F * (A.A2_per_F * direction.dx) +
               (N * (m.beta_s * m.s_max * y.P) - y.sigma * m.beta_s) * Plain<T>(direction.de);
  rate.F = (N * m.F_max - y.F) * (m.beta_F * direction.de);
  return rate;
}

}  // namespace grainlaw
