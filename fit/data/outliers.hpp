#pragma once
// Rows that stand out from their neighbours. Least squares believes every row, so that a few wild ones move a parameter
// far; whoever reads the calibration must hear of them. Judged before any fit, by the series alone:
//   z_i = median over the rows k = i-2 ... i+2 of x_i - (x_k - b (k - i)), b the median step from row to row nearby
//         (fewer rows at the ends of a segment, whose first and last are not judged)
//   an outlier where |z_i| > 8 max(sigma, d_i) and > 5 scales (the misfit that weighs one in the fit)
//   sigma = 1.21 median |x_i - (x_(i-1) + x_(i+1))/2| over the segment, the standard deviation of white noise;
//   d_i = median |step - b| nearby, so that a steep, curved or kinked series has none
// x: ln P*, ln C*, phi_r (scale 0.01 as that of P*), and s_par, F_par in tests with shear; rows that the fit reads only.

#include <string>
#include <vector>

#include "fit/data/data_set.hpp"

namespace grainlaw::fit {

/// One line for each test and column with outliers: "test d2: 2 of 61 rows of s_par stand out ... (rows 17, 23) ...".
std::vector<std::string> outlier_warnings(const DataSet& data, const CalibrationOptions& options);

/// Positions in `x` of what stands out by more than `least`, ascending.
std::vector<std::size_t> outliers_of(const std::vector<double>& x, double least);

}  // namespace grainlaw::fit
