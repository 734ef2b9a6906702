#pragma once
// The ladder of laws behind one right-hand side, cheapest first:
//   reduced    Eqs. (17), (18), P by Eq. (14): dP = B dx, ds = beta_s (s_max N - s) de, dF' = beta_F (F_max N - F') de.
//              Integrated, not evaluated at the current nu as in the paper's figures (reduced_law.hpp); the same at constant nu
//   evolution  Eq. (16), evolution.hpp
//   memory     Eq. (16) with a memory, memory.hpp; where shear turns, s_r jumps or follows s
// d(state) per unit of the path parameter, corotational terms included. No heap, no solver's header.

#include <array>

#include "model/memory.hpp"
#include "model/reduced_law.hpp"
#include "model/vocabulary/enum_names.hpp"

/// Of a function whose inner loop is the law: all that it calls becomes a part of it. Code with assertions or sanitizers is checked, not
/// raced; flattened, it took the compiler more than nine minutes.
#ifdef NDEBUG
#define GRAINLAW_FLATTEN [[gnu::flatten]]
#else
#define GRAINLAW_FLATTEN
#endif

namespace grainlaw {

enum class Rung { reduced, evolution, memory };
constexpr auto names_of(Rung) { return std::array{"reduced", "evolution", "memory"}; }
inline constexpr auto kRungs = kValues<Rung>;  ///< cheapest first

/// What the rung takes from the volume fraction alone.
template <class T>
GRAINLAW_FLATTEN LawModuli<T> law_moduli(const LawParameters<T>& p, double nu, Rung rung) {
  return rung == Rung::memory ? memory_moduli(p, nu) : moduli_at(p, nu);
}

/// Turns the state where the path does: the jump of Rung::memory, which other rungs have not. To be called at every corner.
template <class T>
void turn_corner(Rung rung, LawState<T>& y, const LawDirection& direction) {
  if (rung == Rung::memory && reversal_value(y, direction) < 0.0) reverse(y, direction);
}

/// d(state)/de of `rung` at a state (`coupling` is that of Eq. (16) alone; memory has the energy's), with `m` by law_moduli(p, nu, rung). Finite for
/// P > 0 and finite arguments.
template <class T>
LawState<T> law_rate(const LawModuli<T>& m, const LawParameters<T>& p, Rung rung, Coupling coupling,
                     const LawState<T>& y, const LawDirection& direction) {
  const LawModuli<T> of_shear = along(m, p.lode, direction);
  LawState<T> rate = rung == Rung::memory      ? memory_rate(of_shear, p, y, direction)
                     : rung == Rung::evolution ? evolution_rate(of_shear, p.anisotropy, coupling, y, direction)
                                               : reduced_rate(of_shear, y, direction);
  add_corotation(y, direction, rate);
  return rate;
}

/// The same at volume fraction `nu`.
template <class T>
LawState<T> law_rate(const LawParameters<T>& p, Rung rung, Coupling coupling, const LawState<T>& y, double nu,
                     const LawDirection& direction) {
  return law_rate(law_moduli(p, nu, rung), p, rung, coupling, y, direction);
}

/// law_rate of Rung::memory on a stretch where s_r follows s along N: of the turned state, and <s - s_r, N> stays. Such a
/// stretch begins where <s - s_r, N> falls to zero and ends where its rate with s_r at rest, reversal_rate, rises to zero.
template <class T>
LawState<T> following_rate(const LawModuli<T>& m, const LawParameters<T>& p, LawState<T> y,
                           const LawDirection& direction) {
  reverse(y, direction);
  LawState<T> rate = law_rate(m, p, Rung::memory, Coupling::energy, y, direction);
  rate.s_r += direction.N.template cast<Plain<T>>() * reversal_rate(y, rate, direction);
  return rate;
}

}  // namespace grainlaw
