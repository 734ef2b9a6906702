#pragma once
// The columns of probes.csv, declared once (docs/formats.md is checked against them), and its text.

#include "model/files/column.hpp"
#include "model/vocabulary/probe_row.hpp"

namespace grainlaw {

/// In the order of writing.
const std::vector<Column<ProbeRow>>& probe_columns();

std::string probe_header();                   ///< titles, without the end of the line
std::string probe_line(const ProbeRow& row);  ///< likewise a row

}  // namespace grainlaw
