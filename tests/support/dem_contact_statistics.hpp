#pragma once
// How the trace of the fabric follows from coordination and sizes (hard case D13):
//   tr F = g3 nu C,  g3 = <r^3/Omega>/(<r^3> <1/Omega>),  Omega(r) = 2 pi (1 - sqrt(1 - (<r>/(r + <r>))^2))
// when the part of a sphere's surface that its contacts shade is the same for all sizes (Shaebani et al., Phys. Rev. E
// 85, 011301 (2012)). C is the modified coordination number M4/N.

#include <gtest/gtest.h>

#include <numbers>

#include "dem/engine/averages.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem::scene {

/// g3 of radii uniform on [1, w] by the midpoint rule.
inline double g3_of_uniform_sizes(double w) {
  const double mean = (1 + w) / 2;
  const int points = 20000;
  double r3 = 0, r3_over_Omega = 0, one_over_Omega = 0;
  for (int k = 0; k < points; ++k) {
    const double r = 1 + (w - 1) * (k + 0.5) / points, ratio = mean / (r + mean);
    const double Omega = 2 * std::numbers::pi * (1 - std::sqrt(1 - ratio * ratio));
    r3 += r * r * r / points;
    r3_over_Omega += r * r * r / Omega / points;
    one_over_Omega += 1 / Omega / points;
  }
  return r3_over_Omega / (r3 * one_over_Omega);
}

/// |tr F/(g3 nu C) - 1| of a relaxed packing of the paper's sizes.
inline double fabric_error(std::size_t n, double nu, int threads = 1) {
  Draw draw(n);
  State state = random_state(n, 3, nu, cubic(1), draw);
  EngineOptions engine;
  engine.threads = threads;
  EXPECT_TRUE(relax(state, engine, RelaxOptions{}, RunControl{}).relaxed);
  const Observation seen = observe(start(state), at_rest(state), Deviator<double>::Zero());
  return std::abs(seen.F_v / (g3_of_uniform_sizes(3) * nu * seen.C) - 1);
}

}  // namespace grainlaw::dem::scene
