#include "app/report/svg_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace grainlaw::app::report {
namespace {

struct PixelPoint {
  double x = 0, y = 0;
  double y_low = 0, y_high = 0;  ///< ends of the error bar, or edges of the
                                 ///< band; equal when there is none
};
using Stretch = std::vector<PixelPoint>;  // points without an undefined one between them

std::string colour_class(Colour colour) { return "k" + std::to_string(static_cast<int>(colour)); }

/// Path data of straight lines from point to point.
std::string polyline(const std::vector<std::array<double, 2>>& points) {
  std::string path;
  for (const auto& [x, y] : points) path += fmt::format("{}{} {}", path.empty() ? "M" : "L", pixels(x), pixels(y));
  return path;
}

/// Five points on a circle of `radius`, five between them where the edges of a pentagram meet.
std::string star_path(const PixelPoint& p, double radius) {
  const double inner = radius * std::cos(0.4 * std::numbers::pi) / std::cos(0.2 * std::numbers::pi);
  std::vector<std::array<double, 2>> corners;
  for (int k = 0; k < 10; ++k) {
    const double r = k % 2 == 0 ? radius : inner, angle = 0.2 * std::numbers::pi * k;
    corners.push_back({p.x + r * std::sin(angle), p.y - r * std::cos(angle)});
  }
  return polyline(corners) + "z";
}

/// Path data of a symbol of half width `size` around a point.
std::string marker_path(Marker marker, double size, const PixelPoint& p) {
  const std::string s = pixels(size), d = pixels(2 * size);
  const std::string diagonal = pixels(1.2 * size), double_diagonal = pixels(2.4 * size);
  switch (marker) {
    case Marker::none:
      return "";
    case Marker::circle:
      return fmt::format("M{} {}a{} {} 0 1 0 {} 0a{} {} 0 1 0 -{} 0z", pixels(p.x - size), pixels(p.y), s, s, d, s, s,
                         d);
    case Marker::square:
      return fmt::format("M{} {}h{}v{}h-{}z", pixels(p.x - 0.9 * size), pixels(p.y - 0.9 * size), pixels(1.8 * size),
                         pixels(1.8 * size), pixels(1.8 * size));
    case Marker::triangle:
      return fmt::format("M{} {}l{} {}h-{}z", pixels(p.x), pixels(p.y - 1.2 * size), diagonal, pixels(2.1 * size),
                         double_diagonal);
    case Marker::diamond:
      return fmt::format("M{} {}l{} {}l-{} {}l-{} -{}z", pixels(p.x), pixels(p.y - 1.2 * size), diagonal, diagonal,
                         diagonal, diagonal, diagonal, diagonal);
    case Marker::cross:
      return fmt::format("M{} {}l{} {}m0 -{}l-{} {}", pixels(p.x - size), pixels(p.y - size), d, d, d, d, d);
    case Marker::star:
      return star_path(p, 1.2 * size);
    case Marker::plus:
      return fmt::format("M{} {}h{}M{} {}v{}", pixels(p.x - 1.2 * size), pixels(p.y), double_diagonal, pixels(p.x),
                         pixels(p.y - 1.2 * size), double_diagonal);
  }
  return "";
}

/// The symbols at all `points`: filled, or an outline for open symbols and
/// crosses.
std::string marker_svg(const Series& series, double size, const std::vector<PixelPoint>& points) {
  if (series.marker == Marker::none) return "";
  std::string path;
  for (const PixelPoint& p : points) path += marker_path(series.marker, size, p);
  const bool strokes_only = series.open_marker || series.marker == Marker::cross || series.marker == Marker::plus;
  return fmt::format("<path d=\"{}\"{}/>", path,
                     strokes_only ? R"( fill="none" stroke="currentColor" stroke-width="1.2")"
                                  : R"( fill="currentColor" stroke="none")");
}

std::string line_svg(const Series& series, const std::vector<Stretch>& stretches) {
  if (series.line == Line::none) return "";
  std::string path;
  for (const Stretch& stretch : stretches) {
    if (stretch.size() < 2) continue;
    std::vector<std::array<double, 2>> points;
    for (const PixelPoint& p : stretch) points.push_back({p.x, p.y});
    path += polyline(points);
  }
  const char* const dashes = series.line == Line::dashed   ? R"( stroke-dasharray="7 4")"
                             : series.line == Line::dotted ? R"( stroke-dasharray="1.5 3.5" stroke-linecap="round")"
                                                           : "";
  return fmt::format(R"(<path d="{}" fill="none" stroke="currentColor" stroke-width="{}" stroke-linejoin="round"{}/>)",
                     path, pixels(series.line_width), dashes);
}

std::string error_bar_svg(const std::vector<PixelPoint>& points) {
  std::string path;
  for (const PixelPoint& p : points) {
    if (p.y_low == p.y_high) continue;
    path += fmt::format("M{} {}V{}M{} {}h5M{} {}h5", pixels(p.x), pixels(p.y_low), pixels(p.y_high), pixels(p.x - 2.5),
                        pixels(p.y_low), pixels(p.x - 2.5), pixels(p.y_high));
  }
  return path.empty() ? "" : fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"currentColor\"/>", path);
}

/// Points by point(i), an undefined one ends a stretch.
template <class Point>
std::vector<Stretch> stretches_of(const Series& series, const Point& point) {
  std::vector<Stretch> stretches(1);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (const std::optional<PixelPoint> p = point(i)) {
      stretches.back().push_back(*p);
    } else if (!stretches.back().empty()) {
      stretches.emplace_back();
    }
  }
  return stretches;
}

std::string band_svg(const Series& series, const std::vector<double>& half_width, const Frame& frame) {
  const auto stretches = stretches_of(series, [&](std::size_t i) -> std::optional<PixelPoint> {
    const double x = series.x[i], low = series.y[i] - half_width[i], high = series.y[i] + half_width[i];
    if (!frame.x.defined_at(x) || !frame.y.defined_at(low) || !frame.y.defined_at(high)) return std::nullopt;
    return PixelPoint{frame.px(x), frame.py(series.y[i]), frame.py(low), frame.py(high)};
  });
  std::string path;
  for (const Stretch& stretch : stretches) {
    if (stretch.size() < 2) continue;
    std::vector<std::array<double, 2>> outline;
    for (const PixelPoint& p : stretch) outline.push_back({p.x, p.y_low});
    for (auto p = stretch.rbegin(); p != stretch.rend(); ++p) outline.push_back({p->x, p->y_high});
    path += polyline(outline) + "z";
  }
  if (path.empty()) return path;
  return fmt::format(
      "<path class=\"band\" d=\"{}\" fill=\"currentColor\" "
      "fill-opacity=\"0.14\"/>",
      path);
}

double near(double fraction) { return std::clamp(fraction, -3.0, 4.0); }

bool is_within(const Axis& axis, double value) {
  const double slack = 1e-9, fraction = axis.fraction(value);
  return fraction >= -slack && fraction <= 1 + slack;
}

}  // namespace

std::string pixels(double value) {
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

double Frame::px(double value) const { return left + near(x.fraction(value)) * width; }
double Frame::py(double value) const { return top + (1 - near(y.fraction(value))) * height; }

std::string series_svg(const Series& series, const Frame& frame, Unseen& unseen) {
  std::vector<PixelPoint> within;
  const auto stretches = stretches_of(series, [&](std::size_t i) -> std::optional<PixelPoint> {
    const double x = series.x[i], y = series.y[i];
    if (!frame.x.defined_at(x) || !frame.y.defined_at(y)) {
      ++unseen.undefined;
      return std::nullopt;
    }
    PixelPoint p{frame.px(x), frame.py(y), 0, 0};
    if (i < series.y_error.size() && frame.y.defined_at(y - series.y_error[i]) && series.y_error[i] > 0) {
      p.y_low = frame.py(y - series.y_error[i]);
      p.y_high = frame.py(y + series.y_error[i]);
    }
    if (is_within(frame.x, x) && is_within(frame.y, y)) {
      within.push_back(p);
    } else if (series.marker != Marker::none) {
      ++unseen.outside;
    }
    return p;
  });
  std::string out;
  for (const std::vector<double>& band : series.bands) out += band_svg(series, band, frame);
  out += error_bar_svg(within) + line_svg(series, stretches) + marker_svg(series, series.marker_size, within);
  return fmt::format("<g class=\"{}\"><title>{}</title>{}</g>\n", colour_class(series.colour),
                     escape_markup(to_plain(series.label)), out);
}

std::string legend_key(const Series& series, double x, double y) {
  const PixelPoint left{x, y, 0, 0}, middle{x + 12, y, 0, 0}, right{x + 24, y, 0, 0};
  return fmt::format("<g class=\"{}\">{}{}</g>", colour_class(series.colour), line_svg(series, {{left, right}}),
                     marker_svg(series, std::max(3.0, series.marker_size), {middle}));
}

}  // namespace grainlaw::app::report
