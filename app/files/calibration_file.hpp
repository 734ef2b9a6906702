#pragma once
// calibration.json: how the parameters came about - stages, windows, costs, residuals per test, shear fits.

#include <filesystem>

#include "app/files/json_document.hpp"
#include "fit/calibrate.hpp"

namespace grainlaw::app {

void write_calibration(const std::filesystem::path& file, const fit::Calibration& calibration,
                       const fit::CalibrationOptions& options, const std::string& dataset_digest,
                       const OrderedJson& provenance);

/// Reads stages and shear fits into `calibration`. Throws InvalidInput naming file and key.
void read_calibration(const std::filesystem::path& file, fit::Calibration& calibration);

}  // namespace grainlaw::app
