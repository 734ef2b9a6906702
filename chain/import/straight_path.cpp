#include "chain/import/straight_path.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kSameDirection = 0.05;  // angle up to which a direction passes for a mode that its rows allow, too
constexpr double kEqual = 1e-24;         // squares of distances that differ by rounding alone
constexpr std::size_t kMostWork = 200000000;  // rows times segments

using Tensor = Eigen::Matrix3d;

double component_along(const Tensor& strain, const Tensor& D) { return strain.cwiseProduct(D).sum() / D.squaredNorm(); }

/// The row that misses the piece of line from row `a` to row `b` by most and by more than `tolerance`, or from which on rows go back
/// along it by that much; `a` when there is none.
std::size_t worst_row(const std::vector<Observation>& rows, std::size_t a, std::size_t b, double tolerance) {
  const Tensor from = rows[a].strain.tensor, D = rows[b].strain.tensor - from;
  double worst = tolerance, farthest = 0;
  std::size_t corner = a, turn = a;
  for (std::size_t i = a + 1; i < b; ++i) {
    const Tensor along = rows[i].strain.tensor - from;
    const double e = D.squaredNorm() > 0 ? std::clamp(component_along(along, D), 0.0, 1.0) : 0;
    if (const double off = (along - e * D).norm(); off > worst) {
      worst = off;
      corner = i;
    }
    if (const double back = (farthest - e) * D.norm(); back > worst) {
      worst = back;
      corner = turn;
    }
    if (e <= farthest) continue;
    farthest = e;
    turn = i;
  }
  return corner;
}

/// Rows that are corners between `first` and `last`, without them, appended in order.
void find_corners(const std::vector<Observation>& rows, std::size_t first, std::size_t last, double tolerance,
                  std::vector<std::size_t>& corners) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};  // not by recursion: rows may be many
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const std::size_t corner = worst_row(rows, a, b, tolerance);
    if (corner == a) continue;
    if (corners.size() == kMaxFoundSegments)
      throw InvalidInput(
          fmt::format("the strains turn more than {} times; give a path, a larger path_tolerance (now {:g}), or "
                      "smooth them",
                      kMaxFoundSegments, tolerance));
    corners.push_back(corner);
    open.emplace_back(a, corner);
    open.emplace_back(corner, b);
  }
  std::ranges::sort(corners);
}

/// A direction that a segment may have.
struct NamedStep {
  Mode mode;
  Tensor D;
};

std::vector<NamedStep> candidates_of(const Tensor& step) {
  std::vector<NamedStep> all;
  for (const auto& [mode, names] : {std::pair<Mode, std::vector<const char*>>{Mode::ISO, {"xyz"}},
                                    {Mode::UNI, {"xyz", "xzy", "zyx"}},
                                    {Mode::D2, {"xyz", "xzy", "yxz"}},
                                    {Mode::D3, {"xyz", "xzy", "zyx"}}}) {
    for (const char* axes : names) {
      for (const bool reverse : {false, true}) all.push_back({mode, direction_of(mode, axes, reverse).tensor});
    }
  }
  all.push_back({Mode::tensor, step - step.trace() / 3 * Tensor::Identity()});
  return all;
}

/// Direction of the rows [first, last], of which `start` is the first's place on the path.
PathSegment straight(const std::vector<Observation>& rows, std::size_t first, std::size_t last, const Tensor& start,
                     double tolerance) {
  const Tensor step = rows[last].strain.tensor - start;
  const auto farthest = [&](const Tensor& D) {
    double off = 0;
    for (std::size_t i = first; i <= last; ++i) {
      const Tensor along = rows[i].strain.tensor - start;
      off = std::max(off, (along - component_along(along, D) * D).norm());
    }
    return off;
  };
  NamedStep best{Mode::tensor, step};
  double least = tolerance;
  for (const NamedStep& candidate : candidates_of(step)) {
    const double norm = candidate.D.norm();
    if (!(norm > 0) || !(candidate.D.cwiseProduct(step).sum() > std::cos(kSameDirection) * norm * step.norm()))
      continue;
    const double off = farthest(candidate.D);
    // the traceless tensor has six components to meet the rows with where a mode has none: it comes last
    if (candidate.mode == Mode::tensor ? best.mode != Mode::tensor || off > tolerance : off > least) continue;
    least = off;
    best = candidate;
  }
  if (best.mode == Mode::tensor) best.D /= best.D.norm();
  const double length = component_along(step, best.D), shear = deviatoric_norm(best.D),
               volume = std::abs(best.D.trace());
  PathSegment segment{best.mode, {best.D}, ExtentKind::eps_dev, shear * length};
  if (shear < volume) {
    segment.extent_kind = ExtentKind::eps_vol;
    segment.extent = volume * length;
  }
  return segment;
}

/// The nearest place on a segment that is not before `from`.
struct Place {
  double e = 0, off = 0;
};
Place nearest(const StraightSegment& segment, const Tensor& strain, double from) {
  const Tensor along = strain - segment.strain_start.tensor;
  const Tensor& D = segment.direction.tensor;
  const double e = std::clamp(component_along(along, D), std::min(from, segment.length), segment.length);
  return {e, (along - e * D).norm()};
}

/// The first row of a segment ends the one before it where it is the corner, to `tolerance`, and no row before is nearer.
void end_at_corners(const std::vector<StraightSegment>& segments, const std::vector<Observation>& rows,
                    double tolerance, std::vector<int>& of_row) {
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    if (of_row[i] == of_row[i - 1] || of_row[i] != of_row[i + 1]) continue;
    const Tensor& corner = segments[static_cast<std::size_t>(of_row[i])].strain_start.tensor;
    const double off = (rows[i].strain.tensor - corner).norm();
    if (off <= tolerance && off < (rows[i - 1].strain.tensor - corner).norm()) --of_row[i];
  }
}

/// The last row of a segment that ends it, to `tolerance`, ends it exactly: the next one starts from there.
void end_at(const StraightSegment& segment, const Tensor& strain, double tolerance, Place& place) {
  const double off = (strain - segment.strain(segment.length).tensor).norm();
  if (off <= tolerance) place = {segment.length, off};
}

/// Segment of each row, ascending without gaps, such that the squares of the distances are least; going back on a segment counts as
/// distance. Of equals the earlier segment: a corner ends the segment before it.
std::vector<int> segments_of_rows(const std::vector<StraightSegment>& segments, const std::vector<Observation>& rows) {
  const std::size_t n = rows.size(), K = segments.size();
  if (K == 1) return std::vector<int>(n, 0);
  if (n * K > kMostWork)
    throw InvalidInput(fmt::format("{} rows on {} segments are too many to be sorted; thin the rows", n, K));
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<double> cost(K, kNever), before(K, kNever), at(K, 0), at_before(K, 0);
  std::vector<bool> moved(n * K, false);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < K; ++k) {
      const Place place = nearest(segments[k], rows[i].strain.tensor, 0);
      const double back = i == 0 ? 0 : std::max(0.0, (at_before[k] - place.e) * segments[k].direction.tensor.norm());
      double best = i == 0 ? (k == 0 ? 0 : kNever) : before[k] + back * back;
      if (i > 0 && k > 0 && before[k - 1] <= best + kEqual) {
        best = before[k - 1];
        moved[i * K + k] = true;
      }
      cost[k] = best + place.off * place.off;
      at[k] = place.e;
    }
    std::swap(cost, before);
    std::swap(at, at_before);
  }
  std::vector<int> of_row(n);
  std::size_t k = K - 1;
  for (std::size_t i = n; i-- > 0;) {
    of_row[i] = static_cast<int>(k);
    if (moved[i * K + k]) --k;
  }
  return of_row;
}

}  // namespace

std::vector<PathSegment> found_segments(const std::vector<Observation>& rows, double tolerance) {
  double reach = 0;
  for (const Observation& row : rows) reach = std::max(reach, row.strain.tensor.norm());
  if (!(reach > tolerance))
    throw InvalidInput(
        fmt::format("the strain never exceeds {:.3g}, which path_tolerance, {:g}, takes for none; are its units "
                    "right?",
                    reach, tolerance));
  std::vector<std::size_t> corners;
  find_corners(rows, 0, rows.size() - 1, tolerance, corners);
  corners.push_back(rows.size() - 1);
  std::vector<PathSegment> segments;
  Tensor start = Tensor::Zero();
  std::size_t first = 0;
  for (const std::size_t last : corners) {
    if ((rows[last].strain.tensor - start).norm() <= tolerance) continue;  // at rest
    segments.push_back(straight(rows, first, last, start, tolerance));
    const PathSegment& segment = segments.back();
    const Tensor& D = segment.direction.tensor;
    const double rate = segment.extent_kind == ExtentKind::eps_dev ? deviatoric_norm(D) : std::abs(D.trace());
    start += segment.extent / rate * D;
    first = last;
  }
  return segments;
}

Moved move_onto(const Path& path, double tolerance, std::vector<Observation>& rows) {
  const std::vector<StraightSegment> segments = resolve(path);
  std::vector<int> of_row = segments_of_rows(segments, rows);
  end_at_corners(segments, rows, tolerance, of_row);
  Moved moved;
  double e = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && of_row[i] != of_row[i - 1]) e = 0;
    const StraightSegment& segment = segments[static_cast<std::size_t>(of_row[i])];
    Place place = nearest(segment, rows[i].strain.tensor, e);
    if (i + 1 == rows.size() || of_row[i + 1] != of_row[i]) end_at(segment, rows[i].strain.tensor, tolerance, place);
    e = place.e;
    if (place.off > moved.farthest) moved = {place.off, i};
    rows[i].segment = of_row[i];
    set_strain(rows[i], segment.strain(e));
    rows[i].nu = segment.nu(e);
  }
  return moved;
}

std::string path_text(const Path& path) {
  std::vector<std::string> parts;
  for (const PathSegment& segment : path.segments) {
    const Tensor& D = segment.direction.tensor;
    parts.push_back(fmt::format("{} ({:.4g} {:.4g} {:.4g}{}) to {} {:.6g}", to_string(segment.mode), D(0, 0), D(1, 1),
                                D(2, 2),
                                D.isDiagonal() ? "" : fmt::format(" {:.4g} {:.4g} {:.4g}", D(1, 2), D(0, 2), D(0, 1)),
                                to_string(segment.extent_kind), segment.extent));
  }
  const std::size_t many = 6;
  const bool cut = parts.size() > many;
  if (cut) parts.resize(many);
  return fmt::format("from nu {:.6g}: {}{}", path.nu, fmt::join(parts, ", then "),
                     cut ? fmt::format(", ... {} segments", path.segments.size()) : "");
}

}  // namespace grainlaw::chain
