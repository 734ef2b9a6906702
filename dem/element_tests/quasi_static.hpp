#pragma once
// An element test without dynamics: the cell is deformed in small affine steps, each followed by a minimisation of the
// elastic energy at fixed cell (athermal quasi-static shear, e.g. Maloney and Lemaître, Phys. Rev. E 74, 016118 (2006)). It
// is the limit of vanishing rate of dem/element_tests/element_run.hpp, but for which minimum of several a packing falls into.
//   H_k = exp(e_k D) H_0, e_k = k length/steps, spheres move with the cell, then dem/statics/relax.hpp
//   W_box grows by the change of elastic energy in the affine step, D_contact by what the minimisation takes
// Spheres are at rest in every row, the inertial number is 0, and time is that of a constant strain_rate, for the name only.

#include "dem/element_tests/element_run.hpp"

namespace grainlaw::dem {

/// Affine steps of a segment: of at most quasi_static_step, so many that every row ends one.
std::uint64_t quasi_static_steps(const StraightSegment& segment, const DriveOptions& drive, int rows);

/// As run_element_test(), for options.drive.quasi_static_step > 0; `steps` of the result are force passes. Steps whose
/// minimisation did not reach options.relax.tolerance are warned of. Throws InvalidInput for wall-driven transport.
ElementTest run_quasi_static_test(const State& start, const std::vector<StraightSegment>& segments,
                                  const ElementTestOptions& options, const RunControl& control,
                                  const StepObserver& on_step, const Checkpointing& checkpointing);

/// As continue_element_test().
ElementTest continue_quasi_static_test(Checkpoint from, const std::vector<StraightSegment>& segments,
                                       const ElementTestOptions& options, const RunControl& control,
                                       const StepObserver& on_step, const Checkpointing& checkpointing);

}  // namespace grainlaw::dem
