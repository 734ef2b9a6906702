#pragma once
// The columns of the series that element tests leave on disk, declared once: titles, units, symbols and meaning
// (docs/formats.md is checked against this table).

#include "model/files/column.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw {

/// Columns of a test's series, in the order of writing.
const std::vector<Column<Observation>>& observation_columns();

}  // namespace grainlaw
