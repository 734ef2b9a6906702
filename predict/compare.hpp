#pragma once
// A prediction against the DEM test of the same path, row by row at the observed strains.
//   bias = mean(prediction - DEM),  normalised RMS = RMS(prediction - DEM)/max|DEM|, both over rows with
//   shear_path >= 0.01 (all rows when the path has no shear). NaN where no row counts.
// Coverage of a band: the share of these rows that have one and in which DEM lies within it. NaN without a band.

#include "predict/predict.hpp"

namespace grainlaw::predict {

struct QuantityComparison {
  std::string quantity;                              ///< "P_star", "s_par", "F_par"
  int rows = 0;                                      ///< rows that count: both values defined
  double bias = 0;                                   ///< in the unit of the quantity [-]
  double rms = 0;                                    ///< root mean square of prediction - DEM [-]
  double normalised_rms = 0;                         ///< rms/max|DEM| [-]
  double largest = 0;                                ///< prediction - DEM where its magnitude is largest [-]
  double largest_at_eps_dev = 0, largest_at_nu = 0;  ///< where that is [-]
  double coverage_mean = std::numeric_limits<double>::quiet_NaN();    ///< of the mean curve's band [-]
  double coverage_single = std::numeric_limits<double>::quiet_NaN();  ///< of the single run's band [-]
};

struct Comparison {
  std::string test;                            ///< name of the test
  std::vector<QuantityComparison> quantities;  ///< P_star, s_par, F_par
};

/// `prediction` was made at points_of(test); rows are paired in order, the prediction may end early. Throws InvalidInput
/// when a pair lies at different strains.
Comparison compare(const Prediction& prediction, const TestRecord& test);

}  // namespace grainlaw::predict
