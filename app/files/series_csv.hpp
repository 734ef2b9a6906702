#pragma once
// The series of a test and of a prediction as CSV, doubles bit for bit.

#include <filesystem>
#include <string>
#include <vector>

#include "model/vocabulary/test_record.hpp"
#include "predict/predict.hpp"

namespace grainlaw::app {

std::string series_text(const std::vector<Observation>& rows);
void write_series(const std::filesystem::path& file, const std::vector<Observation>& rows);

/// Reads the series of a test on `path` with `packing`. Columns may come in any order; those that are not required
/// (Column::required) may be missing: what follows from others is computed (eps_vol, eps_dev, shear_path, P_star,
/// s_dev, s_par, F_v, F_dev, F_par), the rest is undefined. Throws InvalidInput naming file, row and column: unknown
/// column or unit, values that contradict each other (nu and strain, P_star and stress, ...), times that do not grow.
std::vector<Observation> read_series(const std::filesystem::path& file, const Path& path, const PackingInfo& packing);

/// Likewise for predictions; the columns of the bands may be missing or empty.
void write_prediction_series(const std::filesystem::path& file, const std::vector<predict::PredictedRow>& rows);
std::vector<predict::PredictedRow> read_prediction_series(const std::filesystem::path& file);

}  // namespace grainlaw::app
