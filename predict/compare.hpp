#pragma once
// A prediction against the DEM test of the same path, row by row at the observed strains.
//   bias = mean(prediction - DEM),  normalised RMS = RMS(prediction - DEM)/max|DEM|, both over rows with
//   shear_path >= 0.01 (all rows when the path has no shear). NaN where no row counts.
// Coverage of a band: the share of these rows that have one and in which DEM lies within it. NaN without a band.

#include <array>

#include "predict/predict.hpp"

namespace grainlaw::predict {

struct QuantityComparison {
  std::string quantity;                              ///< of kComparedQuantities
  int rows = 0;                                      ///< rows that count: both values defined
  double bias = 0;                                   ///< in the unit of the quantity [-]
  double rms = 0;                                    ///< root mean square of prediction - DEM [-]
  double normalised_rms = 0;                         ///< rms/max|DEM| [-]
  double largest = 0;                                ///< prediction - DEM where its magnitude is largest [-]
  double largest_at_eps_dev = 0, largest_at_nu = 0;  ///< where that is [-]
  double coverage_mean = std::numeric_limits<double>::quiet_NaN();    ///< of the mean curve's band [-]
  double coverage_single = std::numeric_limits<double>::quiet_NaN();  ///< of the single run's band [-]
};
GRAINLAW_FIELDS(QuantityComparison, quantity, rows, bias, rms, normalised_rms, largest, largest_at_eps_dev,
                largest_at_nu, coverage_mean, coverage_single);

/// What a prediction is compared by, and the law is judged by: [-] each.
struct ComparedQuantity {
  const char* name;
  double (*predicted)(const PredictedRow&);
  double (*slope)(const RowSlope&);
  double RowBand::*band;
  double Observation::*measured;
};
/// In the order of Rehearsed.
inline constexpr std::array<ComparedQuantity, 3> kComparedQuantities{
    {{"P_star", [](const PredictedRow& row) { return row.state.P; }, [](const RowSlope& row) { return row.state.P; },
      &RowBand::P, &Observation::P_star},
     {"s_par", [](const PredictedRow& row) { return row.s_par; }, [](const RowSlope& row) { return row.s_par; },
      &RowBand::s_par, &Observation::s_par},
     {"F_par", [](const PredictedRow& row) { return row.F_par; }, [](const RowSlope& row) { return row.F_par; },
      &RowBand::F_par, &Observation::F_par}}};

struct Comparison {
  std::string test;                            ///< name of the test
  std::vector<QuantityComparison> quantities;  ///< P_star, s_par, F_par
};
GRAINLAW_FIELDS(Comparison, test, quantities);

/// Shear path from which on rows count: before it the start, not the law, is compared. Zero on a path without shear.
double counts_from(const std::vector<StraightSegment>& path);

/// `prediction` was made at points_of(test); rows are paired in order, the prediction may end early. Throws InvalidInput
/// when a pair lies at different strains.
Comparison compare(const Prediction& prediction, const TestRecord& test);

}  // namespace grainlaw::predict
