// D23: near jamming relaxation slows down, and what it says of itself must stay true. For packings at nu_J + dnu, each
// with its own jamming point nu_J, the plain reference judges the claim
//   relaxed  <=>  largest net force on a sphere <= 1e-5 mean contact force
// nu_J is where the pressure of the decompressed packing goes to zero (linear in nu - nu_J), and it is checked by the
// mean overlap, which grows from zero there: <delta>/<r> = D ln(nu/nu_J), Eq. (13), D about 0.43.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/dem_compression.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using testing::expect_figure;

constexpr double kTolerance = 1e-5;

/// What the plain reference sees of a packing at rest.
struct Seen {
  double net = 0;       ///< largest net force [N]
  double mean = 0;      ///< mean contact force, 0 without contacts [N]
  double pressure = 0;  ///< [Pa]
};

Seen seen(const State& state) {
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  Seen seen;
  double contacts = 0;
  for (const Eigen::Vector3d& f : sums.force) seen.net = std::max(seen.net, f.norm());
  for (const int count : sums.contacts) contacts += 0.5 * count;
  if (contacts > 0) seen.mean = state.material.stiffness * sums.overlap / contacts;
  seen.pressure = sums.virial.trace() / 3 / state.packing.volume();
  return seen;
}

Relaxation relax_at(State& state, double nu, std::int64_t max_passes = RelaxOptions{}.max_passes) {
  scale_to_volume_fraction(state.packing, nu);
  return relax(state, EngineOptions{}, RelaxOptions{kTolerance, max_passes}, RunControl{});
}

struct Jammed {
  State state;      ///< just above its jamming point
  double nu_J = 0;  ///< [-]
};

/// Decompresses a packing towards its jamming point, each time by 7/10 of the way that its pressure leaves.
Jammed approach_jamming(std::size_t n, std::uint64_t seed) {
  Jammed jammed{scene::jammed({"Paper", 3, 0}, n, 0.70, seed), 0};
  double nu = 0.70, next = 0.69, P = seen(jammed.state).pressure;
  for (int k = 0; k < 40; ++k) {
    State less = jammed.state;
    EXPECT_TRUE(relax_at(less, next).relaxed);
    const double P_next = seen(less).pressure;
    if (P_next == 0) break;  // its contacts are gone: the last estimate was a little low
    jammed.nu_J = next - P_next * (nu - next) / (P - P_next);
    jammed.state = less;
    if (next - jammed.nu_J < 1e-7) break;
    nu = next, P = P_next;
    next = jammed.nu_J + 0.3 * (nu - jammed.nu_J);
  }
  return jammed;
}

/// How far a claim is from the truth; positive when it says 'relaxed' of a packing that is not. Positions are known to
/// 1e-16 of a cell of some ten radii, so net forces to 1e-14 k <r>.
double excess(const State& state, const Seen& seen) {
  const double rounding = 1e-14 * state.material.stiffness * mean_radius(state.packing);
  return seen.net / (kTolerance * seen.mean + rounding);
}

TEST(NearJamming, D23RelaxedOnlyInEquilibrium) {
  double worst = 0, disagreement = 0, slope_error = 0;
  int claims = 0, flagged = 0, wrong_flags = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Jammed jammed = approach_jamming(100, seed);
    for (const double dnu : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      for (const std::int64_t max_passes : {10, 100, 500, 200000}) {
        State state = jammed.state;
        const Relaxation result = relax_at(state, jammed.nu_J + dnu, max_passes);
        const Seen truth = seen(state);
        ASSERT_GT(truth.mean, 0) << "above its jamming point the packing has contacts";
        disagreement = std::max(disagreement, std::abs(result.mean_contact_force / truth.mean - 1));
        if (result.relaxed) {
          ++claims;
          worst = std::max(worst, excess(state, truth));
          const double overlap = truth.mean / state.material.stiffness / mean_radius(state.packing);
          slope_error = std::max(slope_error, std::abs(overlap / std::log1p(dnu / jammed.nu_J) / 0.43 - 1));
        } else {
          ++flagged;
          wrong_flags += truth.net <= 0.99 * kTolerance * truth.mean || result.passes != max_passes ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GE(claims, 15) << "given enough passes every one comes to rest";
  EXPECT_GT(flagged, 15) << "and none within 10 passes";
  EXPECT_LE(slope_error, 0.15) << "nu_J is not the jamming point";
  expect_figure("D23.net_force_over_line", worst, 1);
  expect_figure("D23.wrong_flags", wrong_flags, 0);
  expect_figure("D23.mean_force_error", disagreement, 1e-6);
}

// Below its jamming point a packing loses its contacts, or keeps some that touch by rounding only.
TEST(NearJamming, D23BelowJammingNothingIsLeft) {
  const Jammed jammed = approach_jamming(100, 1);
  double left = 0;
  for (const double dnu : {1e-6, 1e-4, 1e-2}) {
    State state = jammed.state;
    EXPECT_TRUE(relax_at(state, jammed.nu_J - dnu).relaxed);
    left = std::max(left, seen(state).net / (state.material.stiffness * mean_radius(state.packing)));
  }
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    scene::Draw draw(seed);
    State state = scene::random_state(100, 3, 0.55, scene::cubic(1), draw);
    EXPECT_TRUE(relax_at(state, 0.55).relaxed);
    left = std::max(left, seen(state).net / (state.material.stiffness * mean_radius(state.packing)));
  }
  expect_figure("D23.unjammed_net_force", left, 1.1e-13);
}

}  // namespace
}  // namespace grainlaw::dem
