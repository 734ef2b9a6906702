#pragma once
// calibration.json: how the parameters came about - stages, windows, costs, residuals per test, shear fits - and how they
// compare with what was published, together with the modes that the law does not read.

#include <filesystem>

#include "fit/calibrate.hpp"
#include "fit/published/verdicts.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::fit {

void write_calibration(const std::filesystem::path& file, const Calibration& calibration,
                       const CalibrationOptions& options, const ModeComparison& modes, const OrderedJson& provenance);

/// Reads stages and shear fits into `calibration`; of the descriptions, too, only these. Throws InvalidInput naming file
/// and key.
ModeComparison read_calibration(const std::filesystem::path& file, Calibration& calibration);

}  // namespace grainlaw::fit
