#pragma once
// Static equilibrium of a packing in a fixed cell by the energy minimiser FIRE (Bitzek et al., Phys. Rev. Lett. 97,
// 170201 (2006)): elastic forces k delta only, no drag, velocities of the minimiser are its own.
// Criterion: max net force on a sphere <= tolerance * mean contact force, or <= 1e-13 k <r>: an unjammed packing whose
// last contacts touch by rounding only.

#include "dem/engine/simulation.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::dem {

struct RelaxOptions {
  double tolerance = 1e-5;           ///< max net force over mean contact force [-]
  std::int64_t max_passes = 200000;  ///< force passes before giving up
};
constexpr auto fields_of(std::type_identity<RelaxOptions>) {
  return std::tuple{Field{&RelaxOptions::tolerance, "relax_tolerance", "", "", "", Rule::fixed},
                    Field{&RelaxOptions::max_passes, "relax_max_passes", "", "", "", Rule::fixed}};
}
static_assert(tells_every_member<RelaxOptions>());

struct Relaxation {
  bool relaxed = false;              ///< criterion met (trivially without contacts)
  double max_net_force = 0;          ///< [N]
  double mean_contact_force = 0;     ///< [N], 0 without contacts
  std::int64_t passes = 0;           ///< force passes used
  double E_before = 0, E_after = 0;  ///< elastic energy at the first and the last of them [J]
};

/// Moves the spheres of `state` to equilibrium at fixed cell; velocities become zero, accelerations and list reference
/// are cleared (the next simulation recomputes them), step, time and ledger are reset.
Relaxation relax(State& state, const EngineOptions& engine, const RelaxOptions& options, const RunControl& control);

}  // namespace grainlaw::dem
