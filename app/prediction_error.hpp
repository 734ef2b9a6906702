#pragma once
// How well a calibration knows the prediction along a path, by the richest rung that is calibrated, quantity by quantity.
// Errors are relative to the largest |value| on the path, and root mean squares over it where shear_path >= 0.01, as those of
// predictions beside DEM are (predict/compare.hpp). More packings narrow the band of the mean curve; they do not mend
// the law's own discrepancy, which is looked for in what the fit leaves over:
//   D^2 = mean over the fitted paths of b^2 - e^2,   b the mean over packings of the bias over the largest |value|, e its
// standard error. Its own error is taken as sqrt(sum of 4 b^2 e^2 + 2 e^4) over the number of paths (normal b).

#include <string>
#include <vector>

#include "fit/calibrate.hpp"
#include "model/law.hpp"
#include "model/path.hpp"

namespace grainlaw::app {

struct QuantityPrecision {
  std::string quantity;        ///< "P_star", "s_par", "F_par"
  double half_width = 0;       ///< of the mean curve's 95 % band, root mean square; NaN: no band [-]
  double largest = 0;          ///< likewise, at its worst place [-]
  double discrepancy = 0;      ///< D; 0 where e explains b, NaN where the rung is not fitted to paths [-]
  double discrepancy_min = 0;  ///< sqrt(max(0, D^2 - 2 of its errors)): D is larger than that [-]
};

struct PredictionError {
  Rung rung = Rung::reduced;
  std::vector<QuantityPrecision> quantities;  ///< those that the path has: s_par only with shear
};

PredictionError prediction_error(const fit::Calibration& calibration, const Path& path);

}  // namespace grainlaw::app
