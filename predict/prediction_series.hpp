#pragma once
// The series of a prediction as CSV, doubles bit for bit.

#include <filesystem>
#include <vector>

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// Columns may come in any order; the columns of the bands may be missing or empty.
void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows);
std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file);

}  // namespace grainlaw::predict
