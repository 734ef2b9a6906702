#include "app/report/svg_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "app/report/svg_path.hpp"

namespace grainlaw::app::report {
namespace {

constexpr double kLineTolerance = 0.2;   ///< of a simplified line [px]
constexpr double kSymbolDistance = 0.5;  ///< symbols closer than this are one [px]

using Stretch = PixelPoints;  // points without an undefined one between them

std::string colour_class(Colour colour) { return "k" + std::to_string(static_cast<int>(colour)); }

/// Five points on a circle of `radius`, five between them where the edges of a pentagram meet.
std::string star_path(double radius) {
  const double inner = radius * std::cos(0.4 * std::numbers::pi) / std::cos(0.2 * std::numbers::pi);
  SvgPath path;
  for (int k = 0; k < 10; ++k) {
    const double r = k % 2 == 0 ? radius : inner, angle = 0.2 * std::numbers::pi * k;
    k == 0 ? path.move(r * std::sin(angle), -r * std::cos(angle))
           : path.line(r * std::sin(angle), -r * std::cos(angle));
  }
  path.close();
  return path.data();
}

/// Path data of a symbol of half width `size` around the origin.
std::string symbol_path(Marker marker, double size) {
  const std::string s = pixels(size), d = pixels(2 * size);
  const std::string side = pixels(1.8 * size), half_side = pixels(0.9 * size);
  const std::string diagonal = pixels(1.2 * size), double_diagonal = pixels(2.4 * size);
  switch (marker) {
    case Marker::none:
      return "";
    case Marker::circle:
      return fmt::format("M-{0} 0a{0} {0} 0 1 0 {1} 0a{0} {0} 0 1 0 -{1} 0z", s, d);
    case Marker::square:
      return fmt::format("M-{0}-{0}h{1}v{1}h-{1}z", half_side, side);
    case Marker::triangle:
      return fmt::format("M0-{0}l{0} {1}h-{1}z", diagonal, double_diagonal);
    case Marker::diamond:
      return fmt::format("M0-{0}l{0} {0}l-{0} {0}l-{0}-{0}z", diagonal);
    case Marker::cross:
      return fmt::format("M-{0}-{0}l{1} {1}m0-{1}l-{1} {1}", s, d);
    case Marker::star:
      return star_path(1.2 * size);
    case Marker::plus:
      return fmt::format("M-{0} 0h{1}M0-{0}v{1}", diagonal, double_diagonal);
  }
  return "";
}

/// Filled, or an outline for open symbols and crosses.
std::string symbol_svg(const Series& series, double size) {
  const bool strokes_only = series.open_marker || series.marker == Marker::cross || series.marker == Marker::plus;
  return fmt::format(R"(<path class="{}" d="{}"/>)", strokes_only ? "o" : "f", symbol_path(series.marker, size));
}

/// Class and width of its line.
std::string line_style(const Series& series) {
  const char* const dashes = series.line == Line::dashed ? " d1" : series.line == Line::dotted ? " d2" : "";
  return fmt::format(R"(class="l{}" stroke-width="{}")", dashes, pixels(series.line_width));
}

std::string line_svg(const Series& series, const std::vector<Stretch>& stretches) {
  if (series.line == Line::none) return "";
  SvgPath path;
  for (const Stretch& stretch : stretches) {
    if (stretch.size() > 1) path.polyline(simplified(stretch, kLineTolerance));
  }
  return fmt::format(R"(<path {} d="{}"/>)", line_style(series), path.data());
}

/// The symbols stand at the corners of a path that is itself not drawn.
std::string markers_svg(const Series& series, const PixelPoints& points, Symbols& symbols) {
  if (series.marker == Marker::none) return "";
  PixelPoints apart;
  for (const auto& p : points) {
    const auto is_there = [&](const auto& q) {
      return std::abs(p[0] - q[0]) < kSymbolDistance && std::abs(p[1] - q[1]) < kSymbolDistance;
    };
    if (apart.empty() || !is_there(apart.back())) apart.push_back(p);
  }
  SvgPath path;
  path.polyline(apart);
  if (apart.size() == 1) path.line(apart[0][0], apart[0][1]);  // a mere point has no corner
  return fmt::format(R"svg(<path class="m" style="marker:url(#{})" d="{}"/>)svg", symbols.id_of(series), path.data());
}

std::string error_bars_svg(const Series& series, const Frame& frame) {
  if (series.y_error.empty()) return "";
  SvgPath path;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y_error.size()); ++i) {
    const double y = series.y[i], error = series.y_error[i];
    if (!frame.x.defined_at(series.x[i]) || !frame.y.defined_at(y) || !frame.y.defined_at(y - error) || !(error > 0))
      continue;
    const double x = frame.px(series.x[i]), low = frame.py(y - error), high = frame.py(y + error);
    path.move(x, low);
    path.line(x, high);
    for (const double end : {low, high}) {
      path.move(x - 2.5, end);
      path.line(x + 2.5, end);
    }
  }
  return fmt::format(R"(<path class="e" d="{}"/>)", path.data());
}

std::string band_svg(const Series& series, const std::vector<double>& half_width, const Frame& frame) {
  SvgPath path;
  PixelPoints low, high;
  const auto draw = [&] {
    if (low.size() > 1) {
      PixelPoints outline = simplified(low, kLineTolerance);
      const PixelPoints back = simplified(high, kLineTolerance);
      outline.insert(outline.end(), back.rbegin(), back.rend());
      path.polyline(outline);
      path.close();
    }
    low.clear();
    high.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double x = series.x[i], bottom = series.y[i] - half_width[i], top = series.y[i] + half_width[i];
    if (!frame.x.defined_at(x) || !frame.y.defined_at(bottom) || !frame.y.defined_at(top)) {
      draw();
      continue;
    }
    low.push_back({frame.px(x), frame.py(bottom)});
    high.push_back({frame.px(x), frame.py(top)});
  }
  draw();
  return fmt::format(R"(<path class="b" d="{}"/>)", path.data());
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

std::string Symbols::id_of(const Series& series) {
  const std::string symbol =
      fmt::format(R"(class="{}">{})", colour_class(series.colour), symbol_svg(series, series.marker_size));
  auto at = std::find(symbols_.begin(), symbols_.end(), symbol);
  if (at == symbols_.end()) at = symbols_.insert(at, symbol);
  return fmt::format("{}-m{}", figure_, at - symbols_.begin());
}

std::string Symbols::definitions() const {
  std::string out = "<defs>";
  for (std::size_t i = 0; i < symbols_.size(); ++i) {
    out += fmt::format(
        R"(<marker id="{}-m{}" viewBox="-12 -12 24 24" markerWidth="24" markerHeight="24" markerUnits="userSpaceOnUse" {}</marker>)",
        figure_, i, symbols_[i]);
  }
  return out + "</defs>\n";
}

std::string series_svg(const Series& series, const std::string& toggle, const Frame& frame, Symbols& symbols,
                       Unseen& unseen) {
  PixelPoints within;
  std::vector<Stretch> stretches(1);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double x = series.x[i], y = series.y[i];
    if (!frame.x.defined_at(x) || !frame.y.defined_at(y)) {
      ++unseen.undefined;
      if (!stretches.back().empty()) stretches.emplace_back();
      continue;
    }
    stretches.back().push_back({frame.px(x), frame.py(y)});
    if (is_within(frame.x, x) && is_within(frame.y, y)) {
      within.push_back(stretches.back().back());
    } else if (series.marker != Marker::none) {
      ++unseen.outside;
    }
  }
  std::string out;
  for (const std::vector<double>& band : series.bands) out += band_svg(series, band, frame);
  out += error_bars_svg(series, frame) + line_svg(series, stretches) + markers_svg(series, within, symbols);
  return fmt::format("<g class=\"s {}{}\"><title>{}</title>{}</g>\n", colour_class(series.colour),
                     toggle.empty() ? "" : " " + toggle, escape_markup(to_plain(series.label)), out);
}

std::string legend_key(const Series& series, double x, double y) {
  std::string out = fmt::format(R"svg(<g class="{}" transform="translate({} {})">)svg", colour_class(series.colour),
                                pixels(x), pixels(y));
  if (series.line != Line::none) out += fmt::format(R"(<path {} d="M0 0h24"/>)", line_style(series));
  if (series.marker != Marker::none)
    out += fmt::format(R"svg(<g transform="translate(12 0)">{}</g>)svg",
                       symbol_svg(series, std::max(3.0, series.marker_size)));
  return out + "</g>";
}

}  // namespace grainlaw::app::report
