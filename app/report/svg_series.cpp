#include "app/report/svg_series.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace grainlaw::app::report {
namespace {

/// Five points on a circle of `radius`, five between them where the edges of a pentagram meet.
std::string star_path(const PixelPoint& p, double radius) {
  const double inner = radius * std::cos(0.4 * std::numbers::pi) / std::cos(0.2 * std::numbers::pi);
  std::string path;
  for (int k = 0; k < 10; ++k) {
    const double r = k % 2 == 0 ? radius : inner, angle = 0.2 * std::numbers::pi * k;
    path += fmt::format("{}{} {}", k == 0 ? "M" : "L", pixels(p.x + r * std::sin(angle)),
                        pixels(p.y - r * std::cos(angle)));
  }
  return path + "z";
}

}  // namespace

std::string pixels(double value) {
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string colour_class(Colour colour) { return "k" + std::to_string(static_cast<int>(colour)); }

std::string marker_path(Marker marker, double size, const std::vector<PixelPoint>& points) {
  std::string path;
  const std::string s = pixels(size), d = pixels(2 * size);
  const std::string diagonal = pixels(1.2 * size), double_diagonal = pixels(2.4 * size);
  for (const PixelPoint& p : points) {
    switch (marker) {
      case Marker::none:
        break;
      case Marker::circle:
        path += fmt::format("M{} {}a{} {} 0 1 0 {} 0a{} {} 0 1 0 -{} 0z", pixels(p.x - size), pixels(p.y), s, s, d, s,
                            s, d);
        break;
      case Marker::square:
        path += fmt::format("M{} {}h{}v{}h-{}z", pixels(p.x - 0.9 * size), pixels(p.y - 0.9 * size), pixels(1.8 * size),
                            pixels(1.8 * size), pixels(1.8 * size));
        break;
      case Marker::triangle:
        path += fmt::format("M{} {}l{} {}h-{}z", pixels(p.x), pixels(p.y - 1.2 * size), diagonal, pixels(2.1 * size),
                            double_diagonal);
        break;
      case Marker::diamond:
        path += fmt::format("M{} {}l{} {}l-{} {}l-{} -{}z", pixels(p.x), pixels(p.y - 1.2 * size), diagonal, diagonal,
                            diagonal, diagonal, diagonal, diagonal);
        break;
      case Marker::cross:
        path += fmt::format("M{} {}l{} {}m0 -{}l-{} {}", pixels(p.x - size), pixels(p.y - size), d, d, d, d, d);
        break;
      case Marker::star:
        path += star_path(p, 1.2 * size);
        break;
      case Marker::plus:
        path += fmt::format("M{} {}h{}M{} {}v{}", pixels(p.x - 1.2 * size), pixels(p.y), double_diagonal, pixels(p.x),
                            pixels(p.y - 1.2 * size), double_diagonal);
        break;
    }
  }
  return path;
}

std::string marker_attributes(Marker marker, bool open) {
  const bool strokes_only = open || marker == Marker::cross || marker == Marker::plus;
  return strokes_only ? R"( fill="none" stroke="currentColor" stroke-width="1.2")"
                      : R"( fill="currentColor" stroke="none")";
}

std::string line_path(const std::vector<std::vector<PixelPoint>>& runs) {
  std::string path;
  for (const auto& run : runs) {
    if (run.size() < 2) continue;
    for (std::size_t i = 0; i < run.size(); ++i) {
      path += fmt::format("{}{} {}", i == 0 ? "M" : "L", pixels(run[i].x), pixels(run[i].y));
    }
  }
  return path;
}

std::string line_attributes(Line line, double width) {
  std::string attributes = fmt::format(
      " fill=\"none\" stroke=\"currentColor\" stroke-width=\"{}\" stroke-linejoin=\"round\"", pixels(width));
  if (line == Line::dashed) attributes += R"( stroke-dasharray="7 4")";
  if (line == Line::dotted) attributes += R"( stroke-dasharray="1.5 3.5" stroke-linecap="round")";
  return attributes;
}

std::string band_path(const std::vector<std::vector<PixelPoint>>& runs) {
  std::string path;
  for (const auto& run : runs) {
    if (run.size() < 2) continue;
    for (std::size_t i = 0; i < run.size(); ++i)
      path += fmt::format("{}{} {}", i == 0 ? "M" : "L", pixels(run[i].x), pixels(run[i].y_low));
    for (std::size_t i = run.size(); i-- > 0;) path += fmt::format("L{} {}", pixels(run[i].x), pixels(run[i].y_high));
    path += "z";
  }
  return path;
}

std::string error_bar_path(const std::vector<PixelPoint>& points) {
  std::string path;
  for (const PixelPoint& p : points) {
    if (p.y_low == p.y_high) continue;
    path += fmt::format("M{} {}V{}M{} {}h5M{} {}h5", pixels(p.x), pixels(p.y_low), pixels(p.y_high), pixels(p.x - 2.5),
                        pixels(p.y_low), pixels(p.x - 2.5), pixels(p.y_high));
  }
  return path;
}

}  // namespace grainlaw::app::report
