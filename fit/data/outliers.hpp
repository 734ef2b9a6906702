#pragma once
// Rows that stand out from their neighbours, and packings from one another. Least squares believes every row, so that a
// few wild ones move a parameter far; whoever reads the calibration must hear of them. Judged before any fit, by the
// series alone, of rows that the fit reads: ln P*, ln C*, phi_r, and s_par, F_par in tests with shear. Formulas:
// docs/theory/fit.md, section Outliers.

#include <string>
#include <vector>

#include "fit/data/data_set.hpp"

namespace grainlaw::fit {

/// One line for each test and column with outliers: "test d2: 2 of 61 rows of s_par stand out ... (rows 17, 23) ...".
std::vector<std::string> outlier_warnings(const DataSet& data, const CalibrationOptions& options);

/// One line where two packings are so far apart that P* of one must be wrong: the strongest in ISO unloading at the largest
/// volume fraction that all have bears more than the weakest even where it is looser by .04.
std::vector<std::string> packing_warnings(const DataSet& data);

/// Positions in `x` of what stands out from its neighbours by eight times their scatter and by more than `least`, ascending. The
/// first is not judged, of the last the scatter is at least the largest step of the others.
std::vector<std::size_t> outliers_of(const std::vector<double>& x, double least);

}  // namespace grainlaw::fit
