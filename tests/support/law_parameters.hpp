#pragma once
// The parameters that tests of the law begin from.

#include "model/parameters.hpp"

namespace grainlaw::testing {

/// The published ones with a2 of equations.md section 2, which the paper does not give.
inline LawParameters<double> coupled_parameters() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  return p;
}

}  // namespace grainlaw::testing
