#pragma once
// What the memory rung adds to Eq. (16), on all trajectories with shear at once; s_max, F_max and the pressures of ISO
// unloading and of steady D2 are those of the stages before. Free: G, alpha, k, lambda, chi, kappa, c_F, a2. Compared, each segment from
// its measured start and each packing at the density at which it carries what the mean of packings does, with windows in which
// a parameter is what decides (docs/decisions/0005-memory-law.md):
//   s   shear at constant volume, eps_dev <= stiffness_window (G, alpha) and the rest (chi), each as much; all rows where the volume changes (a2)
//   F   shear at constant volume, eps_dev <= lag_window (lambda, kappa); all rows where the volume changes (c_F)
//   P   shear at constant volume, all rows (k); elsewhere shown
// Each test and quantity counts the same, in units of the scales in CalibrationOptions.

#include "fit/stages/stage.hpp"
#include "fit/stages/trajectory.hpp"

namespace grainlaw::fit {

/// Stage "memory". A parameter whose relative error is beyond a half, or that the data do not contain, is not identified;
/// without a trajectory that changes the volume of a sheared state these are c_F and a2.
StageDefinition memory_stage(const std::vector<Trajectory>& trajectories, const CalibrationOptions& options);

/// The stage when a law that it builds on is missing: nothing of it is identified, `remedy` says why.
StageDefinition no_memory(const std::string& remedy);

}  // namespace grainlaw::fit
