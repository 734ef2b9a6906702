#pragma once
// How far runs of one path on different packings lie apart, row by row: what a single run adds to the error of a mean curve.
// Of s_par, F_par and dP*/B*, the volumetric strain that P* is off by: packings differ in their jamming density, and near it
// that changes P* by more of its value than farther away. Formula: docs/theory/fit.md, section Scatter of runs.

#include "fit/data/data_set.hpp"
#include "model/calibrated_law.hpp"

namespace grainlaw::fit {

/// Of all tests that the fit reads, the first of each packing on a path; their rows at the same strains and at nu >= `nu_min`.
PackingScatter packing_scatter(const DataSet& data, const LawParameters<double>& law, double nu_min);

}  // namespace grainlaw::fit
