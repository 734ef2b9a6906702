#pragma once
// An element test in time: the cell follows dem/element_tests/drive.hpp, the spheres their equations of motion
// (dem/engine/simulation.hpp). Steps of a segment are equal and rounded up in number, so that segments end exactly and dt is
// at most the engine's. A corner is a jump of the velocity gradient: forces are computed anew there. The run is stopped where
// its energies are out of balance, and warned of where it is no longer quasi-static.

#include <memory>

#include "dem/element_tests/element_run.hpp"
#include "dem/element_tests/stepper.hpp"

namespace grainlaw::dem {

/// `segments` and `options` must outlive the stepper. Steps are time steps. start() and resume() throw InvalidInput for a
/// segment that the engine cannot follow or that would take more than 1e12 steps; judge() throws Error 'energy balance'
/// naming row and residual.
std::unique_ptr<Stepper> make_time_stepper(const std::vector<StraightSegment>& segments,
                                           const ElementTestOptions& options);

}  // namespace grainlaw::dem
