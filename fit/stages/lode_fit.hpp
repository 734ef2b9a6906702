#pragma once
// What the Lode angle of the shear changes of the limits s_max and F_max (evolution.hpp): psi_s and psi_F. The laws of Eq. (20)
// are those of shear like D2; with everything else held, shear like D3 then shows what is different. Rows, quantities and
// weights are those of the stage "evolution".

#include "fit/stages/stage.hpp"
#include "fit/stages/trajectory.hpp"

namespace grainlaw::fit {

/// Shear at constant volume by its Lode angle.
struct ByLodeAngle {
  std::vector<Trajectory> others;     ///< unlike D2; none, where no shear at constant volume is like it
  std::vector<Trajectory> reference;  ///< all the rest
};
ByLodeAngle by_lode_angle(const std::vector<Trajectory>& trajectories);

/// Stage "lode" on trajectories of another Lode angle. Without any both effects are fixed at zero.
StageDefinition lode_stage(const std::vector<Trajectory>& others, const CalibrationOptions& options);

/// The stage when both effects are taken as none.
StageDefinition no_lode(const std::string& why);

}  // namespace grainlaw::fit
