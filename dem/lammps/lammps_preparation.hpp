#pragma once
// Isotropic preparation by LAMMPS, in the steps of dem/element_tests/preparation.hpp: our random gas (the same spheres for the
// same seed) -> compression -> rest -> loading -> unloading; states kept on the way are brought to rest in a copy. All
// with the contacts that were asked for, friction included. Rest: strong drag for 5000 steps at a time in place of a minimiser.

#include <optional>

#include "dem/element_tests/preparation.hpp"
#include "dem/lammps/lammps_test.hpp"

namespace grainlaw::dem {

/// Like prepare() and continue_preparation(); a gas compression that is interrupted goes on, too, a relaxation is made again.
void prepare_with_lammps(const LammpsPlace& place, const PreparationOptions& options, const PreparationSink& sink,
                         std::optional<Checkpoint> from, const RunControl& control, const Checkpointing& checkpointing);

}  // namespace grainlaw::dem
