#include "app/report/svg_figure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/axis.hpp"
#include "app/report/page.hpp"
#include "app/report/svg_series.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app::report {
namespace {

// Layout [px] of a figure 960 px wide; text is 12 px.
constexpr double kWidth = 960;
constexpr double kCharacterWidth = 6.6;
constexpr double kLegendRow = 20, kLegendKey = 30, kLegendGap = 22;
constexpr double kLeft = 74, kLeftShared = 8,
                 kRight = 16;  // half of a label to the right
constexpr double kTitle = 22, kBottom = 44, kBottomShared = 12;

std::string text_element(double x, double y, const std::string& attributes, const Text& text) {
  return fmt::format("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", pixels(x), pixels(y), attributes, to_svg(text));
}

constexpr const char* kCentred = " text-anchor=\"middle\"";

/// Grid, ticks, numbers and labels of a panel.
std::string frame_svg(const Panel& panel, const Frame& frame, bool x_numbers, bool y_numbers) {
  const double left = frame.left, top = frame.top, bottom = top + frame.height, right = left + frame.width;
  const double centre = left + frame.width / 2;
  std::string grid, ticks, numbers;
  for (const Tick& tick : frame.x.ticks) {
    const double x = frame.px(tick.value);
    const bool major = !tick.label.runs.empty();
    if (major) grid += fmt::format("M{} {}V{}", pixels(x), pixels(top), pixels(bottom));
    ticks += fmt::format("M{} {}v{}", pixels(x), pixels(bottom), major ? 5 : 3);
    if (major && x_numbers) numbers += text_element(x, bottom + 18, kCentred, tick.label);
  }
  std::size_t longest = 4;
  for (const Tick& tick : frame.y.ticks) {
    const double y = frame.py(tick.value);
    const bool major = !tick.label.runs.empty();
    if (major) grid += fmt::format("M{} {}H{}", pixels(left), pixels(y), pixels(right));
    ticks += fmt::format("M{} {}h-{}", pixels(left), pixels(y), major ? 5 : 3);
    if (major && y_numbers) numbers += text_element(left - 8, y + 4, " text-anchor=\"end\"", tick.label);
    longest = std::max(longest, character_count(tick.label));
  }
  std::string out = fmt::format("<path class=\"grid\" d=\"{}\"/>\n<path class=\"axis\" d=\"{}\"/>\n", grid, ticks);
  if (panel.zero_line && frame.y.from < 0 && frame.y.to > 0) {
    out += fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n", pixels(left), pixels(frame.py(0)), pixels(right));
  }
  out += fmt::format("<rect class=\"axis\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", pixels(left), pixels(top),
                     pixels(frame.width), pixels(frame.height));
  out += numbers;
  if (!panel.title.runs.empty()) {
    out += text_element(centre, top - 7, std::string(" class=\"title\"") + kCentred, panel.title);
  }
  if (x_numbers) out += text_element(centre, bottom + 37, kCentred, panel.x.label);
  if (y_numbers) {
    const double x = left - 17 - kCharacterWidth * static_cast<double>(std::min<std::size_t>(longest, 7)),
                 y = top + frame.height / 2;
    out += text_element(x, y, fmt::format("{} transform=\"rotate(-90 {} {})\"", kCentred, pixels(x), pixels(y)),
                        panel.y.label);
  }
  return out;
}

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
      legend.svg += legend_key(series, x, y - 4) + text_element(x + kLegendKey, y, "", series.label);
      x += width;
    }
  }
  legend.height = seen.empty() ? 0 : y + 10;
  return legend;
}

/// `style` with each declaration that reads a variable preceded by one with its
/// first value, the light page's: viewers that know no variables skip the
/// second, others the first.
std::string with_plain_colours(const std::string& style) {
  const std::string reads = "var(--";
  std::string out;
  std::size_t copied = 0;
  for (std::size_t at = style.find(reads); at != std::string::npos; at = style.find(reads, copied)) {
    const std::size_t closed = style.find(')', at), end = style.find(';', at);
    const std::size_t begin = style.find_first_not_of(' ', style.find_last_of("{;", at) + 1);
    const std::size_t name = at + reads.size();
    const std::string defined = "--" + style.substr(name, closed - name) + ": ";
    const std::size_t value = style.find(defined) + defined.size();
    out += style.substr(copied, begin - copied) + style.substr(begin, at - begin) +
           style.substr(value, style.find(';', value) - value) + style.substr(closed + 1, end - closed) + " ";
    copied = begin;
    out += style.substr(copied, end - copied);
    copied = end;
  }
  return out + style.substr(copied);
}

}  // namespace

RenderedFigure render_svg(const Figure& figure) {
  const Legend legend = make_legend(figure);
  const int count = static_cast<int>(figure.panels.size());
  const int columns = std::max(1, std::min(figure.columns, count));
  const int rows = (count + columns - 1) / columns;
  const bool shared = figure.shared_axes;
  std::vector<const Panel*> all;
  for (const Panel& panel : figure.panels) all.push_back(&panel);

  const double column_left = shared ? kLeftShared : kLeft;
  const double width = (kWidth - kLeft - column_left * (columns - 1) - kRight * columns) / columns;
  const double row_height = kTitle + figure.panel_height + (shared ? kBottomShared : kBottom);
  const double height = legend.height + rows * row_height + (shared ? kBottom - kBottomShared : 0);

  std::string body;
  Unseen unseen;
  for (int i = 0; i < count; ++i) {
    const Panel& panel = figure.panels[static_cast<std::size_t>(i)];
    const int row = i / columns, column = i % columns;
    const auto panels = shared ? all : std::vector<const Panel*>{&panel};
    const Frame frame{shared_axis(panels, true, std::max(3, static_cast<int>(width / 60))),
                      shared_axis(panels, false, 5),
                      kLeft + column * (width + kRight + column_left),
                      legend.height + row * row_height + kTitle,
                      width,
                      figure.panel_height};
    const std::string clip = fmt::format("{}-clip-{}", figure.id, i);
    body += fmt::format(
        "<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" "
        "width=\"{}\" height=\"{}\"/></clipPath>\n",
        clip, pixels(frame.left), pixels(frame.top), pixels(frame.width), pixels(frame.height));
    body += frame_svg(panel, frame, !shared || i + columns >= count, !shared || column == 0);
    body += fmt::format("<g clip-path=\"url(#{})\">\n", clip);
    for (const Series& series : panel.series) body += series_svg(series, frame, unseen);
    body += "</g>\n";
  }
  const std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} "
      "{}\" role=\"img\" "
      "aria-labelledby=\"{}-title {}-description\">\n<title "
      "id=\"{}-title\">{}</title>\n<desc "
      "id=\"{}-description\">{}</desc>\n"
      "{}{}</svg>\n",
      pixels(kWidth), pixels(height), figure.id, figure.id, figure.id, to_svg(plain(figure.title)), figure.id,
      to_svg(plain(figure.description)), legend.svg, body);
  return {svg, unseen.undefined, unseen.outside};
}

void write_svg(const std::filesystem::path& file, const Figure& figure) {
  std::string svg = render_svg(figure).svg;
  svg.insert(svg.find('>') + 1,
             "\n<style><![CDATA[" +
                 with_plain_colours(page_style() + std::string("svg { background: var(--ground); }")) + "]]></style>");
  write_durably(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg);
}

}  // namespace grainlaw::app::report
