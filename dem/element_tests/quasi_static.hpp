#pragma once
// An element test without dynamics: the cell is deformed in small affine steps, each followed by a minimisation of the
// elastic energy at fixed cell (athermal quasi-static shear, e.g. Maloney and Lemaître, Phys. Rev. E 74, 016118 (2006)). It
// is the limit of vanishing rate of dem/element_tests/time_stepper.hpp, but for which minimum of several a packing falls into.
//   H_k = exp(e_k D) H_0, e_k = k length/steps, spheres move with the cell, then dem/statics/relax.hpp
//   W_box grows by the change of elastic energy in the affine step, D_contact by what the minimisation takes
// Spheres are at rest in every row, the inertial number is 0, and time is that of a constant strain_rate, for the name only.

#include <memory>
#include <stop_token>

#include "dem/element_tests/element_run.hpp"
#include "dem/element_tests/stepper.hpp"

namespace grainlaw::dem {

/// Affine steps of a segment: of at most quasi_static_step, so many that every row ends one. Throws InvalidInput beyond 1e9.
std::uint64_t quasi_static_steps(const StraightSegment& segment, const DriveOptions& drive, int rows);

/// For options.drive.quasi_static_step > 0; `segments` and `options` must outlive the stepper. Its steps of a segment are
/// affine steps, its steps() force passes. Steps whose minimisation did not reach options.relax.tolerance are warned of.
/// Throws InvalidInput for wall-driven transport; start() and step() throw Interrupted when `stop` is requested.
std::unique_ptr<Stepper> make_quasi_static_stepper(const std::vector<StraightSegment>& segments,
                                                   const ElementTestOptions& options, const std::stop_token& stop);

}  // namespace grainlaw::dem
