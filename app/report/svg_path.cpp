#include "app/report/svg_path.hpp"

#include <cmath>
#include <cstdlib>

namespace grainlaw::app::report {
namespace {

/// `tenths`/10 in the fewest characters: "-.5", "12", "3.1"; set apart from what stands before by its sign or a space.
void append_tenths(std::string& out, long tenths) {
  if (tenths < 0) {
    out += '-';
  } else if (!out.empty() && out.back() != 'm') {
    out += ' ';
  }
  const long size = std::labs(tenths), whole = size / 10, tenth = size % 10;
  if (whole != 0 || tenth == 0) out += std::to_string(whole);
  if (tenth != 0) out += {'.', static_cast<char>('0' + tenth)};
}

double distance(const std::array<double, 2>& p, const std::array<double, 2>& a, const std::array<double, 2>& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], squared = dx * dx + dy * dy;
  const double along = squared > 0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / squared : 0;
  const double nearest = std::fmin(1, std::fmax(0, along));
  return std::hypot(p[0] - a[0] - nearest * dx, p[1] - a[1] - nearest * dy);
}

}  // namespace

void SvgPath::to(double x, double y) {
  const long tenths_x = std::lround(10 * x), tenths_y = std::lround(10 * y);
  append_tenths(data_, tenths_x - x_);
  append_tenths(data_, tenths_y - y_);
  x_ = tenths_x;
  y_ = tenths_y;
}

void SvgPath::move(double x, double y) {
  data_ += 'm';
  to(x, y);
  start_x_ = x_;
  start_y_ = y_;
}

void SvgPath::line(double x, double y) { to(x, y); }  // after a move, more coordinates are lines

void SvgPath::close() {
  data_ += 'z';
  x_ = start_x_;
  y_ = start_y_;
}

void SvgPath::polyline(const PixelPoints& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    i == 0 ? move(points[i][0], points[i][1]) : line(points[i][0], points[i][1]);
}

PixelPoints simplified(const PixelPoints& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::array<std::size_t, 2>> stretches{{0, points.size() - 1}};
  while (!stretches.empty()) {
    const auto [first, last] = stretches.back();
    stretches.pop_back();
    double farthest = tolerance;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double off = distance(points[i], points[first], points[last]);
      if (off > farthest) farthest = off, at = i;
    }
    if (at == first) continue;
    kept[at] = true;
    stretches.push_back({first, at});
    stretches.push_back({at, last});
  }
  PixelPoints left;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i]) left.push_back(points[i]);
  }
  return left;
}

}  // namespace grainlaw::app::report
