#include "chain/planning/prediction_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/student.hpp"
#include "predict/bands.hpp"
#include "predict/compare.hpp"

namespace grainlaw::chain {
namespace {

constexpr int kPointsPerSegment = 100;
constexpr double kFromShear = 0.01;  // equations.md 0, errors
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The law along each rehearsal, at its rows.
std::vector<predict::Prediction> along(const CalibratedLaw& law, Rung rung, const std::vector<TestRecord>& rehearsals) {
  std::vector<predict::Prediction> predictions;
  for (const TestRecord& test : rehearsals) {
    predictions.push_back(predict::predict(rung, law.parameters, law.coupling, resolve(test.path),
                                           predict::state_from_law(law.parameters, test.path.nu),
                                           predict::points_of(test), {}, {}, {}));
  }
  return predictions;
}

void set_discrepancy(const std::vector<TestRecord>& rehearsals, const std::vector<predict::Prediction>& predictions,
                     const predict::ComparedQuantity& quantity, bool shears, QuantityPrecision& precision) {
  if (rehearsals.size() < 2) return;
  const double n = static_cast<double>(rehearsals.size());
  std::size_t common = rehearsals.front().rows.size();
  for (const auto& prediction : predictions) common = std::min(common, prediction.rows.size());
  double mean_squares = 0, variances = 0, largest = 0, rows = 0;
  for (std::size_t i = 0; i < common; ++i) {
    double sum = 0, squares = 0, level = 0;
    for (std::size_t j = 0; j < rehearsals.size(); ++j) {
      const Observation& row = rehearsals[j].rows[i];
      const double off = shears && row.shear_path < kFromShear
                             ? kNone
                             : row.*quantity.measured - quantity.predicted(predictions[j].rows[i]);
      sum += off;
      squares += off * off;
      level += row.*quantity.measured;
    }
    if (!std::isfinite(sum)) continue;
    const double mean = sum / n;
    mean_squares += mean * mean;
    variances += (squares - n * mean * mean) / (n - 1) / n;
    largest = std::max(largest, std::abs(level / n));
    ++rows;
  }
  if (rows == 0 || !(largest > 0)) return;
  const double of_law = precision.half_width / student_95(n - 1);
  const double e2 = variances / rows / (largest * largest) + of_law * of_law;
  const double D2 = std::max(0.0, mean_squares / rows / (largest * largest) - e2);
  precision.discrepancy = std::sqrt(D2);
  precision.discrepancy_min = std::sqrt(std::max(0.0, D2 - 2 * std::sqrt(4 * D2 * e2 + 2 * e2 * e2)));
}

}  // namespace

PredictionError prediction_error(const CalibratedLaw& law, const Path& path,
                                 const std::vector<TestRecord>& rehearsals) {
  PredictionError error;
  const auto segments = resolve(path);
  const std::vector<Rung> rungs = calibrated_rungs(law);
  if (rungs.empty()) {
    error.quantities.push_back({"P_star", kNone, kNone, kNone, kNone});
    if (shear_direction(segments).norm() == 0) return error;
    for (const char* quantity : {"s_par", "F_par"}) error.quantities.push_back({quantity, kNone, kNone, kNone, kNone});
    return error;
  }
  error.rung = rungs.back();
  const predict::Prediction prediction =
      predict::predict_with_bands(error.rung, law, segments, predict::state_from_law(law.parameters, path.nu), true,
                                  predict::uniform_points(segments, kPointsPerSegment), {});
  const auto rehearsed = along(law, error.rung, rehearsals);
  const bool shears = prediction.rows.back().shear_path > kFromShear;
  for (const predict::ComparedQuantity& quantity : predict::kComparedQuantities) {
    double largest = 0, widest = 0, squares = 0, rows = 0;
    for (const predict::PredictedRow& row : prediction.rows) {
      const double value = quantity.predicted(row), width = row.mean.*quantity.band;
      if (!std::isfinite(value) || (shears && row.shear_path < kFromShear)) continue;
      largest = std::max(largest, std::abs(value));
      if (!std::isfinite(width)) continue;
      widest = std::max(widest, width);
      squares += width * width;
      ++rows;
    }
    if (!(largest > 0)) continue;
    // a band of no width is that of parameters without an error: nothing is known of it
    const bool known = widest > 0;
    QuantityPrecision precision{quantity.name, known ? std::sqrt(squares / rows) / largest : kNone,
                                known ? widest / largest : kNone, kNone, kNone};
    if (known) set_discrepancy(rehearsals, rehearsed, quantity, shears, precision);
    error.quantities.push_back(precision);
  }
  return error;
}

}  // namespace grainlaw::chain
