#pragma once
// What a data set says when it is calibrated as a whole: the laws, and a prediction by the richest rung that it allows.

#include <optional>

#include "model/files/execution.hpp"
#include "chain/studies/settings_study.hpp"
#include "fit/data/options.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::chain {

/// Densities, ascending, at which the calibration tests are sheared at constant volume.
std::vector<double> shear_densities(const Dataset& dataset);

/// The path in `file` along which a study predicts. Throws InvalidInput for one whose strain the law decides: two laws have no
/// rows at one strain.
Path study_path(const std::filesystem::path& file);

/// The setting `name`: quantities of the laws at `densities`, which with `path` are shown only, and the prediction along it.
/// What the data cannot carry is missing, and the note says why.
SettingOutcome calibrated_setting(const std::string& name, const Changes& changes, const Dataset& dataset,
                                  const fit::CalibrationOptions& options, const std::vector<double>& densities,
                                  const std::optional<Path>& path, const Execution& execution);

}  // namespace grainlaw::chain
