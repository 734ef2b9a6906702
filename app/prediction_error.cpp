#include "app/prediction_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "app/law_quantities.hpp"
#include "app/uncertainty.hpp"
#include "predict/predict.hpp"

namespace grainlaw::app {
namespace {

constexpr int kPointsPerSegment = 100;
constexpr double kFromShear = 0.01;  // equations.md 0, errors
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Name of a test without its seed: runs of one path on several packings.
std::string path_name(const std::string& test) { return test.substr(0, test.rfind("-s")); }

/// Mean over packings of what the law is off by on a path, over the largest |value|, and its squared standard error.
struct PathBias {
  std::vector<double> biases;
  double largest = 0;

  double mean() const {
    double sum = 0;
    for (const double b : biases) sum += b;
    return sum / static_cast<double>(biases.size()) / largest;
  }
  double error_squared() const {
    const double n = static_cast<double>(biases.size());
    if (n < 2) return std::numeric_limits<double>::infinity();
    double squares = 0;
    for (const double b : biases) squares += (b / largest - mean()) * (b / largest - mean());
    return squares / (n - 1) / n;
  }
};

void set_discrepancy(const fit::Calibration& c, Rung rung, QuantityPrecision& precision) {
  std::map<std::string, PathBias> paths;
  for (const fit::Stage& stage : c.stages) {
    if (stage.name != to_string(rung)) continue;
    for (const fit::TestResidual& r : stage.tests) {
      if (!r.in_cost || r.rows == 0 || r.quantity != precision.quantity) continue;
      PathBias& path = paths[path_name(r.test)];
      path.biases.push_back(r.bias);
      path.largest = std::max(path.largest, r.max_abs_data);
    }
  }
  precision.discrepancy = precision.discrepancy_min = kNone;
  double squared = 0, variance = 0, n = 0;
  for (const auto& [name, path] : paths) {
    const double b2 = path.mean() * path.mean(), e2 = path.error_squared();
    if (!std::isfinite(e2)) continue;
    squared += b2 - e2;
    variance += 4 * b2 * e2 + 2 * e2 * e2;
    ++n;
  }
  if (n == 0) return;
  precision.discrepancy = std::sqrt(std::max(0.0, squared / n));
  precision.discrepancy_min = std::sqrt(std::max(0.0, (squared - 2 * std::sqrt(variance)) / n));
}

}  // namespace

PredictionError prediction_error(const fit::Calibration& c, const Path& path) {
  PredictionError error;
  const auto segments = resolve(path);
  const std::optional<Rung> rung = richest_rung(c);
  if (!rung) {
    error.quantities.push_back({"P_star", kNone, kNone, kNone, kNone});
    if (shear_direction(segments).norm() == 0) return error;
    for (const char* quantity : {"s_par", "F_par"}) error.quantities.push_back({quantity, kNone, kNone, kNone, kNone});
    return error;
  }
  error.rung = *rung;
  const predict::Uncertainty uncertainty = uncertainty_of(c);
  predict::Prediction prediction = predict::predict(
      error.rung, c.parameters, c.coupling, segments, predict::state_from_law(c.parameters, path.nu),
      predict::uniform_points(segments, kPointsPerSegment), {}, {}, {}, {uncertainty.parameters, true});
  predict::add_bands(c.parameters, uncertainty, prediction);
  const bool shears = prediction.rows.back().shear_path > kFromShear;
  const auto judge = [&](const char* quantity, auto value, double predict::RowBand::*band) {
    double largest = 0, widest = 0, squares = 0, rows = 0;
    for (const predict::PredictedRow& row : prediction.rows) {
      if (!std::isfinite(value(row)) || (shears && row.shear_path < kFromShear)) continue;
      largest = std::max(largest, std::abs(value(row)));
      const double width = row.mean.*band;
      if (!std::isfinite(width)) continue;
      widest = std::max(widest, width);
      squares += width * width;
      ++rows;
    }
    if (!(largest > 0)) return;
    // a band of no width is that of parameters without an error: nothing is known of it
    const bool known = widest > 0;
    QuantityPrecision precision{quantity, known ? std::sqrt(squares / rows) / largest : kNone,
                                known ? widest / largest : kNone, kNone, kNone};
    set_discrepancy(c, error.rung, precision);
    error.quantities.push_back(precision);
  };
  judge(
      "P_star", [](const auto& row) { return row.state.P; }, &predict::RowBand::P);
  judge(
      "s_par", [](const auto& row) { return row.s_par; }, &predict::RowBand::s_par);
  judge(
      "F_par", [](const auto& row) { return row.F_par; }, &predict::RowBand::F_par);
  return error;
}

}  // namespace grainlaw::app
