#pragma once
// The particles of one test as rows (dem/foreign/particle_series.hpp), for an import as a data set.

#include "chain/import/foreign_rows.hpp"
#include "chain/import/mapping.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::chain {

/// Stiffness is that of the test's packing where "particles" does not say it; the packing's size is that of the frames. Throws
/// InvalidInput naming file, line, column or key, also for a cell that shears.
ForeignRows read_particle_rows(const Mapping& mapping, const TestMapping& test, const RunControl& control);

}  // namespace grainlaw::chain
