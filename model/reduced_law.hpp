#pragma once
// Eqs. (17) and (18) in closed form along a straight segment, with the parameters at the current volume fraction
// (as in Figs. 12 and 14 of the paper), and Eq. (14) for the pressure.
//   s(e) = s_max - (s_max - s_0) exp(-beta_s e),   F(e) = F_max - (F_max - F_0) exp(-beta_F e)
// e is the deviatoric strain since the start of the segment; s_0, F_0 the values there, signed along the segment's
// direction. Its rates assume constant pressure. As differential equations, which along a path of changing nu are not the
// same: dP = B dx, d(sigma'/P) = beta_s (s_max N - sigma'/P) de, dF' = beta_F (F_max N - F') de.

#include "model/evolution.hpp"

namespace grainlaw {

/// Eq. (17) or (18): relaxation from `start` towards `limit` over deviatoric strain `e` [-].
template <class T, class E>
auto saturating(const T& limit, const T& start, const T& rate, const E& e) -> decltype(limit * e) {
  using std::exp;
  return limit - (limit - start) * exp(-rate * e);
}

/// Stress ratio of the reduced model at volume fraction `nu`, signed along the direction of shear.
template <class T>
T reduced_stress_ratio(const LawParameters<T>& p, double nu, const T& s_0, double eps_dev) {
  return saturating(p.stress_ratio_max.value(nu, p.shear_nu_c), s_0, p.stress_rate.value(nu, p.shear_nu_c), eps_dev);
}

/// Deviatoric fabric of the reduced model, likewise.
template <class T>
T reduced_fabric(const LawParameters<T>& p, double nu, const T& F_0, double eps_dev) {
  return saturating(p.fabric_max.value(nu, p.shear_nu_c), F_0, p.fabric_rate.value(nu, p.shear_nu_c), eps_dev);
}

/// The differential form, without corotational terms; `m` by moduli_at.
template <class T>
LawState<T> reduced_rate(const LawModuli<T>& m, const LawState<T>& y, const LawDirection& direction) {
  const Deviator<Plain<T>> N = direction.N.template cast<Plain<T>>();
  LawState<T> rate;
  rate.P = m.B * direction.dx;
  rate.sigma = y.sigma * (rate.P / y.P) + (N * (m.s_max * y.P) - y.sigma) * T(m.beta_s * direction.de);
  rate.F = (N * m.F_max - y.F) * T(m.beta_F * direction.de);
  return rate;
}

}  // namespace grainlaw
