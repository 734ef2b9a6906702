#pragma once
// Static equilibrium of a contact network to the rounding of positions, by Newton's method: K u = f with the stiffness of
// the present contacts (dem/statics/stiffness.hpp), as often as contacts change. Where that leads nowhere (no minimum near, a
// rearrangement on the way) the minimiser of dem/statics/relax.hpp takes over, and Newton's method ends what it began.

#include "dem/statics/relax.hpp"

namespace grainlaw::dem {

struct BalanceOptions {
  double tolerance = 1e-9;           ///< max net force over mean contact force that must be reached [-]
  double aim = 1e-12;                ///< the same where the steps end, if rounding lets them get there [-]
  std::int64_t max_passes = 200000;  ///< force passes of the minimiser before giving up
  int threads = 1;
};

struct Balance {
  bool reached = false;  ///< the tolerance was met (trivially without contacts)
  double residual = 0;   ///< max net force over mean contact force [-]; 0 without contacts
  int newton_steps = 0;
  std::int64_t iterations = 0;  ///< of conjugate gradients
  std::int64_t passes = 0;      ///< force passes of the minimiser, 0 when it was not needed
};

/// Moves the spheres of `state` to equilibrium at fixed cell; all of them should carry load (dem/statics/contact_network.hpp).
/// Velocities and all that remembers motion are left as they are by Newton's steps and cleared by the minimiser.
Balance balance(State& state, const BalanceOptions& options, const RunControl& control);

}  // namespace grainlaw::dem
