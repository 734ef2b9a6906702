#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kStrainTolerance = 1e-9;  // rounding of a strain that was integrated over some 1e6 steps
constexpr double kDensityTolerance = 1e-6;

[[noreturn]] void refuse(const TestRecord& test, std::size_t row, const std::string& why) {
  throw InvalidInput(fmt::format("{}: row {}: {}", test.name, row + 1, why));
}

}  // namespace

std::vector<OutputPoint> uniform_points(const std::vector<StraightSegment>& segments, int per_segment) {
  if (per_segment < 1) throw InvalidInput(fmt::format("points per segment: {} is not positive", per_segment));
  std::vector<OutputPoint> points;
  points.reserve(segments.size() * (static_cast<std::size_t>(per_segment) + 1));
  for (std::size_t k = 0; k < segments.size(); ++k) {
    for (int i = 0; i < per_segment; ++i) points.push_back({static_cast<int>(k), segments[k].length * i / per_segment});
    points.push_back({static_cast<int>(k), segments[k].length});
  }
  return points;
}

std::vector<OutputPoint> points_of(const TestRecord& test) {
  const std::vector<StraightSegment> segments = resolve(test.path);
  std::vector<OutputPoint> points;
  points.reserve(test.rows.size());
  double time = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    const Observation& row = test.rows[i];
    const OutputPoint before = points.empty() ? OutputPoint{} : points.back();
    if (!(row.time >= time))
      refuse(test, i,
             fmt::format("time {} is no number or lies before that of the row above; sort the rows", row.time));
    time = row.time;
    if (!row.strain.tensor.allFinite()) refuse(test, i, "strain is not finite");
    if (row.segment < before.segment || row.segment >= static_cast<int>(segments.size())) {
      refuse(test, i, fmt::format("segment {} is not one of the path's {} in order", row.segment, segments.size()));
    }
    const StraightSegment& segment = segments[static_cast<std::size_t>(row.segment)];
    const Eigen::Matrix3d& D = segment.direction.tensor;
    const double projected = (row.strain.tensor - segment.strain_start.tensor).cwiseProduct(D).sum() / D.squaredNorm();
    double e = std::clamp(projected, 0.0, segment.length);
    // Rounding may put a repeated row an ulp before the one above.
    const bool same_segment = !points.empty() && row.segment == before.segment;
    if (same_segment && e < before.e && (before.e - e) * D.norm() <= kStrainTolerance) e = before.e;
    const double off = (row.strain.tensor - segment.strain(e).tensor).norm();
    if (off > kStrainTolerance) {
      refuse(test, i,
             fmt::format("strain is {:.3g} away from segment {} of the test's path; check the path or the rows", off,
                         row.segment));
    }
    if (same_segment && e < before.e) refuse(test, i, "strain runs back along its segment; sort the rows");
    if (!(std::abs(row.nu - segment.nu(e)) <= kDensityTolerance)) {
      refuse(test, i,
             fmt::format("nu = {:.9g}, but the path has {:.9g} there; give the packing's own volume fraction as "
                         "initial.nu",
                         row.nu, segment.nu(e)));
    }
    points.push_back({row.segment, e});
  }
  return points;
}

}  // namespace grainlaw::predict
