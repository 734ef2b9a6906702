#pragma once
// The parameters that tests of the law begin from.

#include "model/evolution.hpp"
#include "model/parameters.hpp"

namespace grainlaw::testing {

inline constexpr Coupling kCouplings[] = {Coupling::energy, Coupling::single};

/// The published ones with a2 of equations.md section 2, which the paper does not give.
inline LawParameters<double> coupled_parameters() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  return p;
}

/// The same with numbers of the memory's size.
inline LawParameters<double> memory_parameters() {
  LawParameters<double> p = coupled_parameters();
  p.memory = {0.8, 0.7, 2.5, 10, 45, 10, 1.1, 0.7, 0.6, 1.18};
  return p;
}

/// Eq. (16) at volume fraction `nu`.
template <class T>
LawState<T> evolution_rate(const LawParameters<T>& p, Coupling coupling, const LawState<T>& y, double nu,
                           const LawDirection& direction) {
  return grainlaw::evolution_rate(along(moduli_at(p, nu), p.lode, direction), p.anisotropy, coupling, y, direction);
}

}  // namespace grainlaw::testing
