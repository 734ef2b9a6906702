#pragma once
// What the memory rung adds to Eq. (16), on all trajectories with shear at once; s_max, F_max and the pressures of ISO
// unloading and of steady D2 are those of the stages before. Free: G, alpha, k, lambda, chi, kappa, c_F, a2. Compared, each segment from
// its measured start, with windows in which a parameter is what decides (docs/decisions/0005-memory-law.md):
//   s   shear at constant volume, eps_dev <= stiffness_window (G, alpha) and the rest (chi), each as much; all rows where the volume changes (a2)
//   F   shear at constant volume, eps_dev <= lag_window (lambda, kappa); all rows where the volume changes (c_F)
//   P   shear at constant volume, all rows (k); elsewhere shown
// Each test and quantity counts the same, in units of the scales in CalibrationOptions.

#include "fit/statistics/inherited_error.hpp"
#include "fit/statistics/stage_fit.hpp"
#include "fit/stages/trajectory.hpp"

namespace grainlaw::fit {

struct MemoryProblem {
  std::vector<FreeParameter> parameters;
  std::vector<ResidualBlock> blocks;  ///< one per trajectory with shear in its test
};

/// Starts from `start`. Without `volumetric`, c_F and a2 keep its values.
MemoryProblem memory_problem(const std::vector<Trajectory>& trajectories, const LawParameters<double>& start,
                             bool volumetric, const CalibrationOptions& options);

/// Stage "memory"; `law` holds the start and takes the result. A parameter whose relative error is beyond a half, or that
/// the data do not contain, is not identified. Errors contain those of `found` for the laws of the stages before.
StageFit fit_memory(const std::vector<Trajectory>& trajectories, LawParameters<double>& law,
                    const CalibrationOptions& options, const RunControl& control, const FoundErrors& found = {});

/// The stage when a law that it builds on is missing: nothing of it is identified, `remedy` says why.
StageFit no_memory(const std::string& remedy);

}  // namespace grainlaw::fit
