#pragma once
// The columns of the series that element tests and predictions leave on disk, declared once: titles, units, symbols
// and meaning (docs/formats.md is checked against these tables).

#include "app/files/column.hpp"
#include "model/vocabulary/observation.hpp"
#include "predict/predict.hpp"

namespace grainlaw::app {

/// Columns of a test's series, in the order of writing.
const std::vector<Column<Observation>>& observation_columns();

/// Columns of a prediction, in the order of writing.
const std::vector<Column<predict::PredictedRow>>& prediction_columns();

}  // namespace grainlaw::app
