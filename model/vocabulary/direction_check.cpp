#include "model/vocabulary/direction_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace grainlaw {
namespace {

constexpr double kTurned = 0.1;    // shear after which stress and fabric have come to its direction
constexpr double kAligned = 0.93;  // cosine of a mean over shear to its direction

/// Whether the tensor would point along `N` with its sign turned or its axes named otherwise.
bool points_along_with_other_columns(const Deviator<double>& mean, const Deviator<double>& N) {
  const Eigen::Matrix3d a = tensor_of<double>(mean);
  double best = -mean.dot(N);
  std::array<int, 3> axis{0, 1, 2};
  do {
    Eigen::Matrix3d named;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) named(i, j) = a(axis[static_cast<std::size_t>(i)], axis[static_cast<std::size_t>(j)]);
    }
    best = std::max(best, deviator<double>(named).dot(N));
  } while (std::next_permutation(axis.begin(), axis.end()));
  return best > kAligned * mean.norm();
}

}  // namespace

Deviator<double> stress_ratio(const Observation& o) {
  if (!(o.P_star > kLeastPressure)) return Deviator<double>::Zero();
  return deviator<double>(o.stress.tensor) * (3 / o.stress.tensor.trace());
}

std::optional<Misdirection> misdirection(const std::vector<Observation>& rows,
                                         const std::vector<StraightSegment>& segments, double scatter) {
  const auto first = std::ranges::find_if(segments, shears, &StraightSegment::direction);
  if (first == segments.end() || !first->spin.isZero(0)) return std::nullopt;
  const Deviator<double> N = shear_direction(segments);
  const int index = static_cast<int>(first - segments.begin());
  Deviator<double> s = Deviator<double>::Zero(), F = s;
  int count = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Observation& o = rows[i];
    const Eigen::Matrix3d since = o.strain.tensor - rows[0].strain.tensor - first->strain_start.tensor;
    if (o.segment != index || deviatoric_norm(since) < kTurned || !(o.P_star > kSurelyJammed)) continue;
    s += stress_ratio(o);
    F += deviator<double>(o.fabric.tensor);
    last = i;
    ++count;
  }
  if (count == 0) return std::nullopt;
  for (const auto& [sum, name] : {std::pair{s, "stress"}, {F, "fabric"}}) {
    if (!sum.allFinite()) continue;
    const Deviator<double> mean = sum / count;
    const double along = mean.dot(N), across = (mean - along * N).norm();
    if (across <= 0.7 * along + scatter || !points_along_with_other_columns(mean, N)) continue;
    return Misdirection{
        last, name,
        fmt::format("its deviator{} is {:.3g} along the shear and {:.3g} across it, in the mean from {} of the "
                    "shear on; it must point along: two of its columns are swapped, or a sign is turned",
                    name[0] == 's' ? ", over the pressure," : "", along, across, kTurned)};
  }
  return std::nullopt;
}

}  // namespace grainlaw
