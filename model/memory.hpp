#pragma once
// Eq. (16) with a memory: what dilatancy at constant volume, reversals and the fabric of uniaxial paths need
// (docs/decisions/0004-memory-law.md). Compression positive, dimensionless; notation of evolution.hpp, s = sigma'/P.
//   s_b     = s_r + Delta N on |s_b| = s_max        limit of s along N, seen from the stress ratio at the last reversal
//   flow    = (s_b - s)/max(Delta, Delta_least),    S = <flow,N>
//   dP      = B dx + A1 S de + k (P_t - P) (1 - S) de,  P_t = P_iso + (P_D2 - P_iso) f|f|, f = <F',N>/F_max
//   dsigma' = A2 F' dx + DG flow de,                DG = G (nu_P/nu_c - 1)^alpha
//   dF'     = lambda ((F_max/s_max) s - F') de - c_F F' <dx>,  <dx> the compressive part of dx
// P relaxes to its sheared level at constant volume: nu_J = nu_c nu/nu_P is the evolving jamming density, with nu_P the
// density at which the reference, ISO unloading, carries P. To first order, nu_P = nu exp((P - P_iso)/B_iso); below nu_c
// the reference goes on along its tangent. B and DG are those at nu_P.
// A reversal is a jump, s_r := s, where <s - s_r, N> < 0. The rate of a state that should have turned is that of the
// turned one: trial steps of a solver are harmless.

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/evolution.hpp"

namespace grainlaw {

/// Least distance to the limit that the stress stiffens over, in s_max: no small cycle near the limit is stiff.
inline constexpr double kLeastDistance = 0.1;

/// <s - s_r, N>: a reversal is where it is, or falls, below zero. Zero without shear.
template <class T>
T reversal_value(const LawState<T>& y, const LawDirection& direction) {
  return (y.sigma / y.P - y.s_r).dot(direction.N.template cast<T>());
}

/// The jump at a reversal.
template <class T>
void reverse(LawState<T>& y) {
  y.s_r = y.sigma / y.P;
}

/// Volume fraction whose B is that of the reference at `nu`: nu itself, or just above jamming, where B jumps to zero.
template <class T>
T reference_density(const LawParameters<T>& p, double nu) {
  const T jammed = p.isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
  return nu > jammed ? T(nu) : jammed;
}

/// P_iso: Eq. (14), and below jamming its tangent there (negative).
template <class T>
T reference_pressure(const LawParameters<T>& p, double nu) {
  using std::log;
  const T at = reference_density(p, nu);
  return p.isotropic.P_star(at) + p.isotropic.B_star(at) * log(nu / at);
}

/// Moduli of the volume fraction alone, those of the reference at `nu`.
template <class T>
LawModuli<T> memory_moduli(const LawParameters<T>& p, double nu) {
  LawModuli<T> m;
  m.nu = T(nu);
  m.B = p.isotropic.B_star(reference_density(p, nu));
  m.P_iso = reference_pressure(p, nu);
  m.P_steady = p.steady.P_star(nu);
  m.s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  m.F_max = p.fabric_max.value(nu, p.shear_nu_c);
  return m;
}

/// nu_P at the volume fraction of `m`, to first order.
template <class T>
T pressure_density(const LawModuli<T>& m, const T& P) {
  using std::exp;
  return m.nu * exp((P - m.P_iso) / m.B);
}

namespace detail {

/// (s_b - s)/max(Delta, Delta_least).
template <class T>
Deviator<T> memory_flow(const Deviator<T>& s, Deviator<T> s_r, const Deviator<T>& N, const T& s_max) {
  using std::sqrt;
  if ((s - s_r).dot(N) < 0.0) s_r = s;
  if (const T r2 = s_r.squaredNorm(); r2 > s_max * s_max) s_r *= s_max / sqrt(r2);
  const T along = s_r.dot(N), inside = along * along + s_max * s_max - s_r.squaredNorm();
  const T Delta = inside > 0.0 ? T(sqrt(inside) - along) : T(-along);
  const T least = kLeastDistance * s_max;
  return (s_r + N * Delta - s) / (Delta > least ? Delta : least);
}

}  // namespace detail

/// Right-hand side without corotational terms; `m` by memory_moduli. Finite for P > 0.
template <class T>
LawState<T> memory_rate(const LawModuli<T>& m, const LawParameters<T>& p, Coupling coupling, const LawState<T>& y,
                        const LawDirection& direction) {
  using std::abs;
  using std::pow;
  const Deviator<T> N = direction.N.template cast<T>();
  const T nu_P = pressure_density(m, y.P), B = p.isotropic.B_star(nu_P);
  const AnisotropyModuli<T> A = anisotropy_moduli(p.anisotropy, coupling, B, y, N);
  LawState<T> rate;
  rate.P = B * direction.dx;
  rate.sigma = y.F * (A.A2_per_F * direction.dx);
  rate.F = y.F * (-p.memory.c_F * std::max(direction.dx, 0.0));
  if (direction.de == 0) return rate;
  const Deviator<T> s = y.sigma / y.P, flow = detail::memory_flow(s, y.s_r, N, m.s_max);
  const T S = flow.dot(N), f = y.F.dot(N) / m.F_max,
          DG = p.memory.G * pow(nu_P / p.isotropic.pressure.nu_c - 1.0, p.memory.alpha);
  const T P_t = m.P_iso + (m.P_steady - m.P_iso) * f * abs(f);
  rate.P += (A.A1 * S + p.memory.k * (P_t - y.P) * (1.0 - S)) * direction.de;
  rate.sigma += flow * (DG * direction.de);
  rate.F += (s * (m.F_max / m.s_max) - y.F) * (p.memory.lambda * direction.de);
  return rate;
}

}  // namespace grainlaw
