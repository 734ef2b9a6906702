#pragma once
// How far runs of one path on different packings lie apart, row by row: what a single run adds to the error of a mean curve.
//   variance of a path = mean over rows of sum_i (x_i - mean)^2/(G - 1),   G its runs; the paths' variances are averaged
// for s_par, F_par and dP*/B*, the volumetric strain that P* is off by: packings differ in their jamming density, and near
// it that changes P* by more of its value than farther away. B* of ISO unloading at the row's nu.

#include <limits>
#include <vector>

#include "fit/data_set.hpp"
#include "model/parameters.hpp"

namespace grainlaw::fit {

struct PackingScatter {
  int packings = 0;            ///< most runs of one path
  int degrees_of_freedom = 0;  ///< runs beyond the first of each path, all paths
  double compression =
      std::numeric_limits<double>::quiet_NaN();  ///< standard deviation of P*/B* [-]; NaN where no path has two runs
  double s_par = std::numeric_limits<double>::quiet_NaN();  ///< of s_par [-], likewise
  double F_par = std::numeric_limits<double>::quiet_NaN();  ///< of F_par [-], likewise
};

/// Of all tests that the fit reads; rows at nu >= `nu_min` and with pressure. Runs of one path have as many rows.
PackingScatter packing_scatter(const DataSet& data, const LawParameters<double>& law, double nu_min);

}  // namespace grainlaw::fit
