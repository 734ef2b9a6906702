#pragma once
// How well a calibration knows the prediction along a path, by the richest rung that is calibrated, quantity by quantity.
// Errors are relative to the largest |value| on the path, and root mean squares over it where shear_path >= 0.01, as those of
// predictions beside DEM are (predict/compare.hpp). More packings narrow the band of the mean curve; they do not mend the law's own
// discrepancy D, which is measured on rehearsals, DEM runs of the very path by packings of the calibration that are not
// fitted (docs/theory/studies.md, section Discrepancy).

#include <string>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/vocabulary/path.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::chain {

struct QuantityPrecision {
  std::string quantity;        ///< "P_star", "s_par", "F_par"
  double half_width = 0;       ///< of the mean curve's 95 % band, root mean square; NaN: no band [-]
  double largest = 0;          ///< likewise, at its worst place [-]
  double discrepancy = 0;      ///< D; 0 where e explains it, NaN without two rehearsals [-]
  double discrepancy_min = 0;  ///< sqrt(max(0, D^2 - 2 of its errors)): D is larger than that [-]
};

struct PredictionError {
  Rung rung = Rung::reduced;
  std::vector<QuantityPrecision> quantities;  ///< those that the path has: s_par only with shear
};

/// `rehearsals`: of `path`, one for each packing.
PredictionError prediction_error(const CalibratedLaw& law, const Path& path, const std::vector<TestRecord>& rehearsals);

}  // namespace grainlaw::chain
