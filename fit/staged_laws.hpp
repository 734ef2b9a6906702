#pragma once
// The density laws of one mode of deformation, stage by stage into a Calibration: Eqs. (11) to (14) on an unloading
// branch, Eqs. (11), (12), (14) on steady shear, Eqs. (17), (18) per test and Eq. (20) over density.

#include <string>

#include "fit/calibrate.hpp"
#include "fit/data/data_set.hpp"
#include "fit/data/density_series.hpp"
#include "fit/stages/stage.hpp"

namespace grainlaw::fit {

/// Parameters at their start, nothing identified but the fixed nu_c of Eq. (20), no stages, no errors.
Calibration nothing_known();

/// Runs a stage with what was found so far and takes over what it says; it replaces what earlier ones said of the same
/// parameters.
void run(const StageDefinition& stage, Calibration& calibration, const CalibrationOptions& options,
         const RunControl& control);

/// Stages "coordination", "rattlers", "pressure", "fabric_trace". `branch` names the rows in the stages' windows.
void fit_unloading_laws(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                        const CalibrationOptions& options, const RunControl& control);

/// Stage "overlap" on the same rows, once nothing moves the nu_c of Eq. (14) any more.
void fit_overlap_law(const std::string& branch, const std::vector<DensitySeries>& series, Calibration& calibration,
                     const CalibrationOptions& options, const RunControl& control);

/// Stages "steady_coordination", "steady_rattlers", "steady_pressure" on steady shear of `mode`; left out, with the
/// remedy, when no test reaches it.
void fit_steady_laws(Mode mode, const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                     const RunControl& control);

/// Stages "shear", "stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate" on the tests at constant volume, Eq. (20)
/// on those like D2 where there are any; reads nu_c of Eq. (14).
void fit_shear_laws(const DataSet& data, Calibration& calibration, const CalibrationOptions& options,
                    const RunControl& control);

/// Gives jamming densities of Eq. (11) that are those of the pressure, where nobody counted contacts, their errors as they are now.
void tie_errors(CalibratedLaw& law);

bool all_converged(const Calibration& calibration);

}  // namespace grainlaw::fit
