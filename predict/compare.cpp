#include "predict/compare.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kFirstStrain = 0.01;
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr double kStrainMismatch = 1e-8;  // what points_of() accepts, and some

void check_pairs(const Prediction& prediction, const TestRecord& test) {
  if (prediction.rows.size() > test.rows.size()) {
    throw InvalidInput(fmt::format("{}: {} predicted rows for {} observed ones; predict at points_of(test)", test.name,
                                   prediction.rows.size(), test.rows.size()));
  }
  for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
    const double off = (prediction.rows[i].strain.tensor - test.rows[i].strain.tensor).norm();
    if (!(off <= kStrainMismatch)) {
      throw InvalidInput(
          fmt::format("{}: row {}: predicted at another strain than observed ({:.3g} apart); predict at "
                      "points_of(test)",
                      test.name, i + 1, off));
    }
  }
}

/// Share of rows within a band.
struct Coverage {
  int rows = 0, within = 0;

  void add(double difference, double half_width) {
    if (!std::isfinite(half_width)) return;
    ++rows;
    if (std::abs(difference) <= half_width) ++within;
  }
  double share() const { return rows > 0 ? static_cast<double>(within) / rows : kUndefined; }
};

QuantityComparison compare_quantity(const ComparedQuantity& quantity, const Prediction& prediction,
                                    const TestRecord& test, double from) {
  QuantityComparison result;
  result.quantity = quantity.name;
  double sum = 0, sum_of_squares = 0, largest_observed = 0;
  Coverage mean, single;
  for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
    const PredictedRow& row = prediction.rows[i];
    const double p = quantity.predicted(row), o = test.rows[i].*quantity.measured;
    if (row.shear_path < from || !std::isfinite(p) || !std::isfinite(o)) continue;
    const double difference = p - o;
    ++result.rows;
    sum += difference;
    sum_of_squares += difference * difference;
    mean.add(difference, row.mean.*quantity.band);
    single.add(difference, row.single.*quantity.band);
    largest_observed = std::max(largest_observed, std::abs(o));
    if (result.rows == 1 || std::abs(difference) > std::abs(result.largest)) {
      result.largest = difference;
      result.largest_at_eps_dev = row.eps_dev;
      result.largest_at_nu = row.nu;
    }
  }
  if (result.rows == 0) {
    result.bias = result.rms = result.normalised_rms = result.largest = kUndefined;
    result.largest_at_eps_dev = result.largest_at_nu = kUndefined;
    return result;
  }
  result.coverage_mean = mean.share();
  result.coverage_single = single.share();
  result.bias = sum / result.rows;
  result.rms = std::sqrt(sum_of_squares / result.rows);
  result.normalised_rms = largest_observed > 0 ? result.rms / largest_observed : kUndefined;
  return result;
}

}  // namespace

double counts_from(const std::vector<StraightSegment>& path) {
  // decided by the path, not by the rows reached: one of isotropic segments only has no shear to wait for
  return shear_direction(path).isZero() ? 0 : kFirstStrain;
}

Comparison compare(const Prediction& prediction, const TestRecord& test) {
  check_pairs(prediction, test);
  const double from = counts_from(resolve(test.path));
  Comparison comparison;
  comparison.test = test.name;
  for (const ComparedQuantity& quantity : kComparedQuantities)
    comparison.quantities.push_back(compare_quantity(quantity, prediction, test, from));
  return comparison;
}

}  // namespace grainlaw::predict
