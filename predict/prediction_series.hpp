#pragma once
// The series of a prediction as CSV, doubles bit for bit.

#include <filesystem>
#include <vector>

#include "model/files/column.hpp"
#include "predict/predict.hpp"

namespace grainlaw::predict {

/// The columns, in the order in which they are written.
const std::vector<Column<PredictedRow>>& prediction_columns();

/// Columns may come in any order; the columns of the bands may be missing or empty.
void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows);
std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file);

}  // namespace grainlaw::predict
