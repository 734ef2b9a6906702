#pragma once
// calibration.json: how the parameters came about - stages, windows, costs, residuals per test, shear fits - and how they
// compare with what was published, together with the modes that the law does not read.

#include <filesystem>

#include "model/files/json_document.hpp"
#include "app/published/verdicts.hpp"
#include "fit/calibrate.hpp"

namespace grainlaw::app {

void write_calibration(const std::filesystem::path& file, const fit::Calibration& calibration,
                       const fit::CalibrationOptions& options, const ModeComparison& modes,
                       const std::string& dataset_digest, const OrderedJson& provenance);

/// Reads stages and shear fits into `calibration`; of the descriptions, too, only these. Throws InvalidInput naming file
/// and key.
ModeComparison read_calibration(const std::filesystem::path& file, fit::Calibration& calibration);

}  // namespace grainlaw::app
