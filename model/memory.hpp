#pragma once
// Eq. (16) with a memory: what dilatancy at constant volume, reversals and the fabric of uniaxial paths need
// (docs/decisions/0005-memory-law.md). Compression positive, dimensionless; notation of evolution.hpp, s = sigma'/P.
//   Delta   distance from s_r, the stress ratio at the last reversal, along N to |s| = s_lim;  xi = |s - s_r|/Delta
//   flow    = N - q xi^(n-1) (s - s_r)/Delta,       S = <flow,N>, on co-axial paths 1 - q xi^n
//   n       = 1 + (m - 1) (1 + <E,N>)^2,            dE = (N - E) de/eps_E, the fading memory of the direction of shear
//   dP      = B dx + A1 S de + k (1 - h S) (P_t - P) de,   P_t = P_iso + (P_D2 - P_iso) f|f|, f = <F',N>/F_max
//   dsigma' = a2 B F' dx + DG flow de - B |s - a2 F'| (M - flow_M) <-dx>,   DG = G (nu_P/nu_c - 1)^alpha; M the direction of
//             s - a2 F', flow_M the flow of shear along it with n = m: by elasticity alone expansion takes s away from a2 F',
//             beyond any limit as P vanishes, and to that loading a packing yields as to shear
//   dF'     = lambda (r s - F') de + kappa r d_e s - c_F (F' - kappa r s)/(1 - kappa) <dx>,   r = F_max/s_max, <dx> the compressive part,
//             d_e s = (d_e sigma' - s d_e P)/P the change of s by shear alone: share kappa of the fabric follows stress at once,
//             and compression dilutes what does not; c_F is the rate where F' = r s
//   A1      = (2/3)(a_P B <F',N> - <sigma',N>)
//   s_lim   = s_max (z + sqrt(1 + z^2)), z = chi k (P_t - P)/(B s_max)   stress-dilatancy: while the packing would dilate, it bears
//             more, while it would contract, less: s_max + chi k (P_t - P)/B to first order, and never negative
//   q       = 1 - min(1, max(0, B <dx> <s - a2 F',N>/(DG de))), the share of shear that loads: by elasticity alone compression takes
//             the stress ratio down, and only what shear adds beyond that is plastic; 1 where the volume is constant or grows
// P relaxes to its sheared level at constant volume: nu_J = nu_c nu/nu_P is the evolving jamming density, with nu_P the
// density at which the reference, ISO unloading, carries P. To first order, nu_P = nu exp((P - P_iso)/B_iso); below nu_c
// the reference goes on along its tangent. B and DG are those at nu_P.
// Shear has turned where <s - s_r, N> < 0, and takes with it what lies along N alone: s_r += <s - s_r, N> N. At a corner
// that is a jump, which vanishes where the turn just begins to be one, so that the response is a continuous function of the
// direction of shear. Within a segment (compression takes s down faster than shear brings it up, or spin) it is a stretch on
// which s_r follows s along N, until loading goes on: d<s - s_r, N> = 0. The rate of a state that should have turned is that of
// the turned one: trial steps of a solver are harmless.

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/evolution.hpp"

namespace grainlaw {

/// Delta, in s_lim, below which the stress goes to its limit no faster: no small cycle near the limit is stiff. There
/// flow = (Delta N - xi^j (s - s_r))/D, D this distance, xi = (|s - s_r| + D - Delta)/D and j = (n - 1) Delta/D: as elsewhere
/// at Delta = D, linear at Delta = 0.
inline constexpr double kLeastDistance = 0.1;

/// xi from which on the way back to the limit gets no steeper, where the stress ratio lies beyond it [-].
inline constexpr double kMostBeyond = 2;

/// eps_E, the shear strain over which the direction of shear is remembered [-].
inline constexpr double kStrainMemory = 0.3;

/// h: the part of the relaxation of P that waits for plastic shear [-].
inline constexpr double kPlasticRelaxation = 0.5;

/// <s - s_r, N>: shear has turned where it is below zero. Zero without shear.
template <class T>
T reversal_value(const LawState<T>& y, const LawDirection& direction) {
  return (y.sigma / y.P - y.s_r).dot(direction.N.template cast<Plain<T>>());
}

/// Makes it zero: the jump where shear has turned.
template <class T>
void reverse(LawState<T>& y, const LawDirection& direction) {
  y.s_r += direction.N.template cast<Plain<T>>() * reversal_value(y, direction);
}

/// Rate of <s - s_r, N> at `y` with d(state)/de = `rate`.
template <class T>
T reversal_rate(const LawState<T>& y, const LawState<T>& rate, const LawDirection& direction) {
  const Deviator<T> s = (rate.sigma - y.sigma * (rate.P / y.P)) / y.P;
  return (s - rate.s_r).dot(direction.N.template cast<Plain<T>>());
}

/// E after shear along a straight segment from e = 0 to `e`.
inline Deviator<double> strain_memory(const Deviator<double>& E, const LawDirection& direction, double e) {
  return direction.N + (E - direction.N) * std::exp(-direction.de * e / kStrainMemory);
}

/// Volume fraction whose B is that of the reference at `nu`: nu itself, or just above jamming, where B jumps to zero.
template <class T>
T reference_density(const LawParameters<T>& p, double nu) {
  const T jammed = p.isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
  return nu > jammed ? T(nu) : jammed;
}

/// Moduli of the volume fraction alone, those of the reference at `nu`.
template <class T>
LawModuli<T> memory_moduli(const LawParameters<T>& p, double nu) {
  LawModuli<T> m;
  m.nu = T(nu);
  using std::log;
  const T at = reference_density(p, nu);
  const auto P_and_B = p.isotropic.P_and_B(at);
  m.B = P_and_B[1];
  m.P_iso = P_and_B[0] + m.B * log(nu / at);
  m.P_steady = p.steady.P_star(nu);
  m.s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  m.F_max = p.fabric_max.value(nu, p.shear_nu_c);
  m.F_fall = fabric_fall(p, nu);
  return m;
}

/// nu_P at the volume fraction of `m`, to first order.
template <class T>
T pressure_density(const LawModuli<T>& m, const T& P) {
  using std::exp;
  return m.nu * exp((P - m.P_iso) / m.B);
}

/// How the stress ratio answers to shear that loads, with the exponent n: N at a reversal, 0 on the limit [-].
template <class T, class U>
Deviator<T> memory_flow(const Deviator<T>& s, Deviator<T> s_r, const Deviator<U>& N, const T& s_lim, const T& n) {
  using std::pow;
  using std::sqrt;
  const T turned = (s - s_r).dot(N);
  if (turned < 0.0) s_r += turned * N;
  const T along = s_r.dot(N);
  const Deviator<T> across = s_r - along * N;
  T across2 = across.squaredNorm();
  if (across2 > s_lim * s_lim) {  // shear along N would miss the limit
    s_r -= across * (1.0 - s_lim / sqrt(across2));
    across2 = s_lim * s_lim;
  }
  const T square = s_lim * s_lim - across2, least = kLeastDistance * s_lim;
  const T Delta = square > 0.0 ? T(sqrt(square) - along) : T(-along);
  const Deviator<T> gone = s - s_r;
  const T gone2 = gone.squaredNorm(), D = Delta < least ? least : Delta;
  const Deviator<T> elastic = N * T(Delta / D);
  if (!(gone2 > 0.0)) return elastic;  // where the slopes of sqrt and pow are infinite
  const T xi = (sqrt(gone2) + (D - Delta)) / D, near = Delta > 0.0 ? T(Delta / D) : T(0.0);
  return elastic - gone * (pow(xi < kMostBeyond ? xi : T(kMostBeyond), (n - 1.0) * near) / D);
}

/// k (P_t - P), how fast P goes to its sheared level where the shear is along N [-].
template <class T, class U>
T pressure_relaxation(const LawModuli<T>& m, const LawParameters<T>& p, const LawState<T>& y, const Deviator<U>& N) {
  using std::abs;
  const T f = y.F.dot(N) / m.F_max, P_t = m.P_iso + (m.P_steady - m.P_iso) * f * abs(f);
  return p.memory.k * (P_t - y.P);
}

/// s_lim at that relaxation [-].
template <class T>
T dilating_limit(const LawModuli<T>& m, const LawParameters<T>& p, const T& relaxation, const T& B) {
  using std::sqrt;
  const T z = T(p.memory.chi * relaxation / B) / m.s_max;
  return m.s_max * (z + sqrt(1.0 + z * z));
}

/// B |s - a2 F'| (M - flow_M): what yields of dsigma' per unit of volumetric expansion.
template <class T>
Deviator<T> expansion_yield(const LawModuli<T>& m, const LawParameters<T>& p, const LawState<T>& y, const T& B) {
  using std::sqrt;
  const Deviator<T> s = y.sigma / y.P, away = s - y.F * p.memory.a2;
  const T away2 = away.squaredNorm();
  if (!(away2 > 0.0)) return Deviator<T>::Zero();  // where the slope of sqrt is infinite
  const T loading = sqrt(away2);
  const Deviator<T> M = away / loading;
  const T s_lim = dilating_limit(m, p, pressure_relaxation(m, p, y, M), B);
  return (M - memory_flow(s, y.s_r, M, s_lim, p.memory.m)) * (B * loading);
}

/// Right-hand side without corotational terms; `m` by memory_moduli, with limits along `direction`. Finite for P > 0; for
/// slopes to nu_c a little below it, too.
template <class T>
LawState<T> memory_rate(const LawModuli<T>& m, const LawParameters<T>& p, const LawState<T>& y,
                        const LawDirection& direction) {
  using std::pow;
  const Deviator<Plain<T>> N = direction.N.template cast<Plain<T>>();
  const T nu_P = pressure_density(m, y.P), B = p.isotropic.B_star(nu_P);
  LawState<T> rate;
  rate.P = B * direction.dx;
  rate.sigma = y.F * (p.memory.a2 * B * direction.dx);
  const Deviator<T> s = y.sigma / y.P;
  const T r = m.F_max / m.s_max;
  rate.F = (y.F - s * (p.memory.kappa * r)) * (p.memory.c_F * -std::max(direction.dx, 0.0) / (1.0 - p.memory.kappa));
  if (direction.dx < 0) rate.sigma -= expansion_yield(m, p, y, B) * Plain<T>(-direction.dx);
  if (direction.de == 0) return rate;
  rate.E = (N - y.E) * Plain<T>(direction.de / kStrainMemory);
  const T relaxation = pressure_relaxation(m, p, y, N), s_lim = dilating_limit(m, p, relaxation, B);
  const T remembered = 1.0 + y.E.template cast<T>().dot(N);
  const Deviator<T> loading = memory_flow(s, y.s_r, N, s_lim, T(1.0 + (p.memory.m - 1.0) * remembered * remembered));
  const T A1 = (2.0 / 3.0) * (p.memory.a_P * B * y.F.dot(N) - y.sigma.dot(N));
  const T above = nu_P / p.isotropic.pressure.nu_c - 1.0;  // below zero in a law whose nu_c was moved, for slopes
  const T DG = above > 0.0 ? T(p.memory.G * pow(above, p.memory.alpha)) : T(0.0);
  const T taken = B * std::max(direction.dx, 0.0) * (s - y.F * p.memory.a2).dot(N), added = DG * direction.de;
  const T q = !(taken > 0.0) ? T(1.0) : taken < added ? T(1.0 - taken / added) : T(0.0);
  const Deviator<T> flow = N + (loading - N) * q;
  const T S = flow.dot(N);
  const T sheared_P = (A1 * S + relaxation * (1.0 - kPlasticRelaxation * S)) * direction.de;
  const Deviator<T> sheared_s = (flow * added - s * sheared_P) / y.P;
  rate.P += sheared_P;
  rate.sigma += flow * added;
  rate.F += (s * r - y.F) * (p.memory.lambda * direction.de) + sheared_s * (p.memory.kappa * r);
  return rate;
}

}  // namespace grainlaw
