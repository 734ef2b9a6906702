#pragma once
// What the stage "evolution" may claim: limits and rates of Eq. (20) only where shear goes on for long enough to tell the
// limit from the slope, at enough densities; a rate or a coupling only where it acts on something.

#include "fit/data/options.hpp"
#include "fit/stages/trajectory.hpp"
#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

/// Withdraws the laws of Eq. (20) of which saturation is shown at fewer than three densities, and rates that act on next to
/// nothing. `fit` is that of `trajectories`, whose blocks are those of evolution_blocks(); `law` the fitted one.
void check_evolution(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law,
                     const CalibrationOptions& options, StageFit& fit);

/// Withdraws a2 or a0 of that `name` where it is not felt, or has an error of half its size.
void check_coupling(const std::string& name, const std::string& remedy, StageFit& fit);

}  // namespace grainlaw::fit
