#include "app/report/svg_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/report/axis.hpp"
#include "app/report/svg_series.hpp"

namespace grainlaw::app::report {
namespace {

// Layout [px] of a figure 960 px wide; text is 12 px.
constexpr double kWidth = 960;
constexpr double kCharacterWidth = 6.6;
constexpr double kLegendRow = 20, kLegendKey = 30, kLegendGap = 22;
constexpr double kLeft = 74, kLeftShared = 8, kRight = 16;  // half of a label to the right
constexpr double kTitle = 22, kBottom = 44, kBottomShared = 12;

struct Box {
  double left = 0, top = 0, width = 0, height = 0;  ///< of the axes, without labels
};

/// Smallest and largest defined value along one axis of the given panels.
struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();

  void add(double value, const AxisStyle& style) {
    if (!std::isfinite(value) || (style.logarithmic && value <= 0)) return;
    if (style.floor && value < *style.floor) return;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

Axis make_axis(const std::vector<const Panel*>& panels, bool horizontal, int wanted_ticks) {
  const AxisStyle& style = horizontal ? panels.front()->x : panels.front()->y;
  Extent extent;
  for (const Panel* panel : panels) {
    for (const Series& series : panel->series) {
      const auto& values = horizontal ? series.x : series.y;
      for (std::size_t i = 0; i < values.size(); ++i) {
        // What is not drawn must not stretch the axis.
        if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
        extent.add(values[i], style);
        if (!horizontal && i < series.y_error.size()) {
          extent.add(values[i] - series.y_error[i], style);
          extent.add(values[i] + series.y_error[i], style);
        }
        for (const std::vector<double>& band : series.bands) {
          if (horizontal) break;
          extent.add(values[i] - band[i], style);
          extent.add(values[i] + band[i], style);
        }
      }
    }
  }
  if (style.include) extent.add(*style.include, style);
  if (!(extent.lowest <= extent.highest)) extent = style.logarithmic ? Extent{0.1, 1} : Extent{0, 1};
  const double lowest = style.from.value_or(extent.lowest), highest = style.to.value_or(extent.highest);
  if (style.logarithmic) return logarithmic_axis(lowest, highest, wanted_ticks);
  if (style.from && style.to) return linear_axis(lowest, highest, wanted_ticks, true);
  Axis axis = linear_axis(lowest, highest, wanted_ticks);
  if (style.from || style.to) {
    axis = linear_axis(style.from.value_or(axis.from), style.to.value_or(axis.to), wanted_ticks, true);
  }
  return axis;
}

std::string text_element(double x, double y, const std::string& attributes, const std::string& content) {
  return fmt::format("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", pixels(x), pixels(y), attributes, content);
}

struct PanelRenderer {
  const Panel& panel;
  Axis x, y;
  Box box;
  bool x_numbers = true, y_numbers = true;
  std::string clip;  ///< id of the clip path
  int undefined = 0, outside = 0;

  double px(double value) const { return box.left + near(x.fraction(value)) * box.width; }
  double py(double value) const { return box.top + (1 - near(y.fraction(value))) * box.height; }

  /// Far outside is as good as just outside, and keeps the numbers in the file small.
  static double near(double fraction) { return std::clamp(fraction, -3.0, 4.0); }

  std::string frame() const {
    const double bottom = box.top + box.height, right = box.left + box.width;
    std::string grid, ticks, numbers;
    for (const Tick& tick : x.ticks) {
      const std::string at = pixels(px(tick.value));
      const bool major = !tick.label.runs.empty();
      if (major) grid += fmt::format("M{} {}V{}", at, pixels(box.top), pixels(bottom));
      ticks += fmt::format("M{} {}v{}", at, pixels(bottom), major ? 5 : 3);
      if (major && x_numbers) {
        numbers += text_element(px(tick.value), bottom + 18, " text-anchor=\"middle\"", to_svg(tick.label));
      }
    }
    for (const Tick& tick : y.ticks) {
      const std::string at = pixels(py(tick.value));
      const bool major = !tick.label.runs.empty();
      if (major) grid += fmt::format("M{} {}H{}", pixels(box.left), at, pixels(right));
      ticks += fmt::format("M{} {}h-{}", pixels(box.left), at, major ? 5 : 3);
      if (major && y_numbers) {
        numbers += text_element(box.left - 8, py(tick.value) + 4, " text-anchor=\"end\"", to_svg(tick.label));
      }
    }
    std::string out = fmt::format("<path class=\"grid\" d=\"{}\"/>\n<path class=\"axis\" d=\"{}\"/>\n", grid, ticks);
    if (panel.zero_line && y.from < 0 && y.to > 0) {
      out += fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n", pixels(box.left), pixels(py(0)), pixels(right));
    }
    out += fmt::format("<rect class=\"axis\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", pixels(box.left),
                       pixels(box.top), pixels(box.width), pixels(box.height));
    out += numbers;
    if (!panel.title.runs.empty()) {
      out += text_element(box.left + box.width / 2, box.top - 7, " class=\"title\" text-anchor=\"middle\"",
                          to_svg(panel.title));
    }
    if (x_numbers) {
      out += text_element(box.left + box.width / 2, bottom + 37, " text-anchor=\"middle\"", to_svg(panel.x.label));
    }
    if (y_numbers) {
      std::size_t longest = 4;
      for (const Tick& tick : y.ticks) longest = std::max(longest, character_count(tick.label));
      const double lx = box.left - 17 - kCharacterWidth * static_cast<double>(std::min<std::size_t>(longest, 7)),
                   ly = box.top + box.height / 2;
      out += text_element(
          lx, ly, fmt::format(" text-anchor=\"middle\" transform=\"rotate(-90 {} {})\"", pixels(lx), pixels(ly)),
          to_svg(panel.y.label));
    }
    return out;
  }

  bool within(double vx, double vy) const {
    const double slack = 1e-9, fx = x.fraction(vx), fy = y.fraction(vy);
    return fx >= -slack && fx <= 1 + slack && fy >= -slack && fy <= 1 + slack;
  }

  std::string shade(const Series& series, const std::vector<double>& half_width) const {
    std::vector<std::vector<PixelPoint>> runs(1);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double vx = series.x[i], low = series.y[i] - half_width[i], high = series.y[i] + half_width[i];
      if (!x.defined_at(vx) || !y.defined_at(low) || !y.defined_at(high)) {
        if (!runs.back().empty()) runs.emplace_back();
        continue;
      }
      runs.back().push_back({px(vx), py(series.y[i]), py(low), py(high)});
    }
    const std::string path = band_path(runs);
    if (path.empty()) return path;
    return fmt::format("<path class=\"band\" d=\"{}\" fill=\"currentColor\" fill-opacity=\"0.14\"/>", path);
  }

  std::string ink(const Series& series) {
    std::vector<PixelPoint> symbols;
    std::vector<std::vector<PixelPoint>> runs(1);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double vx = series.x[i], vy = series.y[i];
      if (!x.defined_at(vx) || !y.defined_at(vy)) {
        ++undefined;
        if (!runs.back().empty()) runs.emplace_back();
        continue;
      }
      PixelPoint p{px(vx), py(vy), 0, 0};
      if (i < series.y_error.size() && y.defined_at(vy - series.y_error[i]) && series.y_error[i] > 0) {
        p.y_low = py(vy - series.y_error[i]);
        p.y_high = py(vy + series.y_error[i]);
      }
      runs.back().push_back(p);
      if (within(vx, vy)) {
        symbols.push_back(p);
      } else if (series.marker != Marker::none) {
        ++outside;
      }
    }
    std::string out;
    for (const std::vector<double>& band : series.bands) out += shade(series, band);
    const std::string bars = error_bar_path(symbols);
    if (!bars.empty()) out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"currentColor\"/>", bars);
    if (series.line != Line::none) {
      out += fmt::format("<path d=\"{}\"{}/>", line_path(runs), line_attributes(series.line, series.line_width));
    }
    if (series.marker != Marker::none) {
      out += fmt::format("<path d=\"{}\"{}/>", marker_path(series.marker, series.marker_size, symbols),
                         marker_attributes(series.marker, series.open_marker));
    }
    const std::string label = escape_markup(to_plain(series.label));
    return fmt::format("<g class=\"{}\"><title>{}</title>{}</g>\n", colour_class(series.colour), label, out);
  }

  std::string render() {
    std::string out =
        fmt::format("<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", clip,
                    pixels(box.left), pixels(box.top), pixels(box.width), pixels(box.height));
    out += frame();
    out += fmt::format("<g clip-path=\"url(#{})\">\n", clip);
    for (const Series& series : panel.series) out += ink(series);
    return out + "</g>\n";
  }
};

struct Legend {
  std::string svg;
  double height = 0;
};

/// Entries in rows above the panels, each label once.
Legend make_legend(const Figure& figure) {
  Legend legend;
  std::vector<std::string> seen;
  double x = 10, y = 14;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      const std::string label = to_plain(series.label);
      if (label.empty() || std::find(seen.begin(), seen.end(), label) != seen.end()) continue;
      seen.push_back(label);
      const double width =
          kLegendKey + kCharacterWidth * static_cast<double>(character_count(series.label)) + kLegendGap;
      if (x > 10 && x + width > kWidth) {
        x = 10;
        y += kLegendRow;
      }
      legend.svg += fmt::format("<g class=\"{}\">", colour_class(series.colour));
      const PixelPoint left{x, y - 4, 0, 0}, middle{x + 12, y - 4, 0, 0}, right{x + 24, y - 4, 0, 0};
      if (series.line != Line::none) {
        legend.svg += fmt::format("<path d=\"{}\"{}/>", line_path({{left, right}}),
                                  line_attributes(series.line, series.line_width));
      }
      if (series.marker != Marker::none) {
        legend.svg +=
            fmt::format("<path d=\"{}\"{}/>", marker_path(series.marker, std::max(3.0, series.marker_size), {middle}),
                        marker_attributes(series.marker, series.open_marker));
      }
      legend.svg += "</g>" + text_element(x + kLegendKey, y, "", to_svg(series.label));
      x += width;
    }
  }
  legend.height = seen.empty() ? 0 : y + 10;
  return legend;
}

}  // namespace

RenderedFigure render_svg(const Figure& figure) {
  RenderedFigure rendered;
  const Legend legend = make_legend(figure);
  const int count = static_cast<int>(figure.panels.size());
  const int columns = std::max(1, std::min(figure.columns, count));
  const int rows = (count + columns - 1) / columns;
  const bool shared = figure.shared_axes;
  std::vector<const Panel*> all;
  for (const Panel& panel : figure.panels) all.push_back(&panel);

  const double first_left = kLeft;
  const double column_left = shared ? kLeftShared : kLeft;
  const double width = (kWidth - first_left - column_left * (columns - 1) - kRight * columns) / columns;
  const double row_height = kTitle + figure.panel_height + (shared ? kBottomShared : kBottom);
  const double height = legend.height + rows * row_height + (shared ? kBottom - kBottomShared : 0);

  std::string body;
  for (int i = 0; i < count; ++i) {
    const Panel& panel = figure.panels[static_cast<std::size_t>(i)];
    const int row = i / columns, column = i % columns;
    const auto panels = shared ? all : std::vector<const Panel*>{&panel};
    const int x_ticks = std::max(3, static_cast<int>(width / 60));
    PanelRenderer renderer{panel, make_axis(panels, true, x_ticks), make_axis(panels, false, 5), {}, true, true, {}};
    renderer.box = {first_left + column * (width + kRight + column_left), legend.height + row * row_height + kTitle,
                    width, figure.panel_height};
    renderer.x_numbers = !shared || i + columns >= count;
    renderer.y_numbers = !shared || column == 0;
    renderer.clip = fmt::format("{}-clip-{}", figure.id, i);
    body += renderer.render();
    rendered.undefined_points += renderer.undefined;
    rendered.outside_points += renderer.outside;
  }
  rendered.svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-labelledby=\"{}-title {}-description\">\n<title id=\"{}-title\">{}</title>\n<desc "
      "id=\"{}-description\">{}</desc>\n"
      "{}{}</svg>\n",
      pixels(kWidth), pixels(height), figure.id, figure.id, figure.id, to_svg(plain(figure.title)), figure.id,
      to_svg(plain(figure.description)), legend.svg, body);
  return rendered;
}

}  // namespace grainlaw::app::report
