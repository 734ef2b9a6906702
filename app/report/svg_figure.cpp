#include "app/report/svg_figure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/page.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app::report {
namespace {

// Layout [px] of a figure 1000 px wide; text is 12 px.
constexpr double kWidth = 1000, kWidest = 600;
constexpr double kCharacterWidth = 6.6;
constexpr double kLegendRow = 20, kLegendKey = 30, kLegendGap = 22;
constexpr double kRight = 16;  // half of a label to the right
constexpr double kTop = 8, kTitle = 22, kBottom = 44;

constexpr const char* kCentred = " text-anchor=\"middle\"";

std::string text_element(double x, double y, const std::string& attributes, const Text& text) {
  return fmt::format("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", pixels(x), pixels(y), attributes, to_svg(text));
}

/// Grid, ticks and numbers of a panel: all that changes with the shown range.
std::string scale_svg(const Panel& panel, const Frame& frame) {
  const double left = frame.left, top = frame.top, bottom = top + frame.height, right = left + frame.width;
  std::string grid, ticks, numbers;
  for (const Tick& tick : frame.x.ticks) {
    const double x = frame.px(tick.value);
    const bool major = !tick.label.runs.empty();
    if (major) grid += fmt::format("M{} {}V{}", pixels(x), pixels(top), pixels(bottom));
    ticks += fmt::format("M{} {}v{}", pixels(x), pixels(bottom), major ? 5 : 3);
    if (major) numbers += text_element(x, bottom + 18, kCentred, tick.label);
  }
  for (const Tick& tick : frame.y.ticks) {
    const double y = frame.py(tick.value);
    const bool major = !tick.label.runs.empty();
    if (major) grid += fmt::format("M{} {}H{}", pixels(left), pixels(y), pixels(right));
    ticks += fmt::format("M{} {}h-{}", pixels(left), pixels(y), major ? 5 : 3);
    if (major) numbers += text_element(left - 8, y + 4, " text-anchor=\"end\"", tick.label);
  }
  if (panel.zero_line && frame.y.from < 0 && frame.y.to > 0)
    ticks += fmt::format("M{} {}H{}", pixels(left), pixels(frame.py(0)), pixels(right));
  return fmt::format("<g class=\"a\"><path class=\"grid\" d=\"{}\"/><path class=\"axis\" d=\"{}\"/>\n{}</g>\n", grid,
                     ticks, numbers);
}

/// What the i-th panel shows, in words: "title of the figure: ordinate over abscissa".
std::string panel_name(const Figure& figure, std::size_t i) {
  const Panel& panel = figure.panels[i];
  const std::string title = to_plain(panel.title);
  return fmt::format("{}: {}{} over {}", figure.title, title.empty() ? "" : title + ", ", to_plain(panel.y.label),
                     to_plain(panel.x.label));
}

/// The scale, the frame, title and labels.
std::string axes_svg(const Panel& panel, const Frame& frame) {
  const double centre = frame.left + frame.width / 2, middle = frame.top + frame.height / 2;
  std::string out = scale_svg(panel, frame);
  out += fmt::format("<rect class=\"axis\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", pixels(frame.left),
                     pixels(frame.top), pixels(frame.width), pixels(frame.height));
  if (!panel.title.runs.empty())
    out += text_element(centre, frame.top - 7, std::string(" class=\"title\"") + kCentred, panel.title);
  out += text_element(centre, frame.top + frame.height + 37, kCentred, panel.x.label);
  return out + text_element(13, middle, fmt::format("{} transform=\"rotate(-90 13 {})\"", kCentred, pixels(middle)),
                            panel.y.label);
}

/// Room for the numbers and the label of the ordinate.
double left_of(const std::vector<Frame>& frames) {
  std::size_t longest = 2;
  for (const Frame& frame : frames) {
    for (const Tick& tick : frame.y.ticks) longest = std::max(longest, character_count(tick.label));
  }
  return 30 + kCharacterWidth * static_cast<double>(longest);
}

std::string svg_begin(double width, double height, const std::string& attributes) {
  return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\"{}>\n", pixels(width),
                     pixels(height), attributes);
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

RenderedFigure render(const Figure& figure) {
  RenderedFigure rendered;
  const auto& panels = figure.panels;
  rendered.columns = std::max(1, std::min(figure.columns, static_cast<int>(panels.size())));
  rendered.width = std::min(kWidest, kWidth / rendered.columns);
  const bool titled = std::any_of(panels.begin(), panels.end(), [](const Panel& p) { return !p.title.runs.empty(); });
  const double top = titled ? kTitle : kTop;
  rendered.height = top + figure.panel_height + kBottom;
  std::vector<const Panel*> all;
  for (const Panel& panel : panels) all.push_back(&panel);
  for (const Panel& panel : panels) {
    const auto sharing = figure.shared_axes ? all : std::vector<const Panel*>{&panel};
    rendered.frames.push_back({shared_axis(sharing, true, std::max(3, static_cast<int>(rendered.width / 75))),
                               shared_axis(sharing, false, 5), 0, top, 0, figure.panel_height});
    for (const Series& series : panel.series) {
      if (!series.toggle.empty() && std::ranges::find(rendered.toggles, series.toggle) == rendered.toggles.end())
        rendered.toggles.push_back(series.toggle);
    }
  }
  const double left = left_of(rendered.frames);
  Symbols symbols(figure.id);
  Unseen unseen;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    Frame& frame = rendered.frames[i];
    frame.left = left;
    frame.width = rendered.width - left - kRight;
    const std::string clip = fmt::format("{}-clip-{}", figure.id, i);
    std::string svg =
        svg_begin(rendered.width, rendered.height,
                  fmt::format(" class=\"p\" role=\"img\" aria-label=\"{}\"", to_html(plain(panel_name(figure, i)))));
    svg += fmt::format("<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", clip,
                       pixels(frame.left), pixels(frame.top), pixels(frame.width), pixels(frame.height));
    svg += axes_svg(panels[i], frame) + fmt::format("<g clip-path=\"url(#{})\">\n", clip);
    for (const Series& series : panels[i].series) {
      const auto at = std::find(rendered.toggles.begin(), rendered.toggles.end(), series.toggle);
      const std::string toggle = series.toggle.empty() ? "" : fmt::format("t{}", at - rendered.toggles.begin());
      svg += series_svg(series, toggle, frame, symbols, unseen);
    }
    rendered.panels.push_back(svg + "</g>\n</svg>\n");
  }
  // Symbols of all panels are defined in the first.
  if (!panels.empty()) rendered.panels[0].insert(rendered.panels[0].find('\n') + 1, symbols.definitions());
  rendered.undefined_points = unseen.undefined;
  rendered.outside_points = unseen.outside;
  return rendered;
}

std::vector<const Series*> legend_entries(const Figure& figure) {
  std::vector<const Series*> entries;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      const std::string label = to_plain(series.label);
      const auto is_there = [&](const Series* other) { return to_plain(other->label) == label; };
      if (!label.empty() && std::none_of(entries.begin(), entries.end(), is_there)) entries.push_back(&series);
    }
  }
  return entries;
}

std::string figure_svg(const Figure& with_hidden) {
  Figure figure = with_hidden;
  for (Panel& panel : figure.panels) std::erase_if(panel.series, [](const Series& s) { return s.initially_hidden; });
  const RenderedFigure rendered = render(figure);
  const double width = rendered.columns * rendered.width;
  std::string legend;
  double x = 10, y = 14;
  for (const Series* entry : legend_entries(figure)) {
    const double taken = kLegendKey + kCharacterWidth * static_cast<double>(character_count(entry->label)) + kLegendGap;
    if (x > 10 && x + taken > width) {
      x = 10;
      y += kLegendRow;
    }
    legend += legend_key(*entry, x, y - 4) + text_element(x + kLegendKey, y, "", entry->label);
    x += taken;
  }
  const double top = legend.empty() ? 0 : y + 10;
  std::string panels;
  for (std::size_t i = 0; i < rendered.panels.size(); ++i) {
    const int row = static_cast<int>(i) / rendered.columns, column = static_cast<int>(i) % rendered.columns;
    panels += fmt::format("<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", pixels(column * rendered.width),
                          pixels(top + row * rendered.height), pixels(rendered.width), pixels(rendered.height)) +
              rendered.panels[i].substr(std::string("<svg").size());
  }
  const std::size_t rows = (rendered.panels.size() + static_cast<std::size_t>(rendered.columns) - 1) /
                           static_cast<std::size_t>(rendered.columns);
  return svg_begin(width, top + static_cast<double>(rows) * rendered.height,
                   fmt::format(" role=\"img\" aria-labelledby=\"{0}-title {0}-description\"", figure.id)) +
         fmt::format("<title id=\"{0}-title\">{1}</title>\n<desc id=\"{0}-description\">{2}</desc>\n", figure.id,
                     to_svg(plain(figure.title)), to_svg(plain(figure.description))) +
         legend + panels + "</svg>\n";
}

void write_svg(const std::filesystem::path& file, const Figure& figure) {
  std::string svg = figure_svg(figure);
  svg.insert(svg.find('>') + 1,
             "\n<style><![CDATA[" +
                 with_plain_colours(page_style() + std::string("svg { background: var(--ground); }")) + "]]></style>");
  write_durably(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg);
}

}  // namespace grainlaw::app::report
