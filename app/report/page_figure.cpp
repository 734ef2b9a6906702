#include "app/report/page_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "app/report/axis.hpp"
#include "app/report/svg_figure.hpp"

namespace grainlaw::app::report {
namespace {

constexpr double kManyTimes =
    100;  // from which largest over smallest on their logarithms are packed: 18 bits of P* at jamming
constexpr unsigned kUndefinedCode = 262143, kLargestCode = 262142;  // of 18 bits

/// The figure's arrays as JSON, each once: many series share their abscissae.
class Arrays {
 public:
  std::size_t index_of(const std::vector<double>& values, bool logarithmic) {
    const auto [at, added] = places_.try_emplace(packed_numbers(values, logarithmic), places_.size());
    if (added) text_ += (text_.empty() ? "" : ",\n") + at->first;
    return at->second;
  }
  std::string json() const { return "[" + text_ + "]"; }

 private:
  std::map<std::string, std::size_t> places_;
  std::string text_;
};

nlohmann::ordered_json axis_data(const AxisStyle& style, const Axis& axis) {
  return {to_plain(style.label), axis.from, axis.to, axis.logarithmic ? 1 : 0};
}

/// The figure's numbers, safe inside a <script> element: no '<', no line separator of JavaScript.
std::string figure_data(const Figure& figure, const RenderedFigure& rendered) {
  Arrays arrays;
  nlohmann::ordered_json document{
      {"title", to_plain(plain(figure.title))}, {"columns", rendered.columns}, {"panels", nlohmann::json::array()}};
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    const Frame& frame = rendered.frames[i];
    nlohmann::ordered_json entry{{"title", to_plain(panel.title)},
                                 {"x", axis_data(panel.x, frame.x)},
                                 {"y", axis_data(panel.y, frame.y)},
                                 {"series", nlohmann::json::array()}};
    if (panel.zero_line) entry["zero"] = 1;
    for (const Series& series : panel.series) {
      nlohmann::ordered_json drawn{{"label", to_plain(series.label)},
                                   {"x", arrays.index_of(series.x, frame.x.logarithmic)},
                                   {"y", arrays.index_of(series.y, frame.y.logarithmic)}};
      if (!series.y_error.empty()) drawn["error"] = arrays.index_of(series.y_error, false);
      auto bands = nlohmann::ordered_json::array();
      for (const auto& band : series.bands) bands.push_back(arrays.index_of(band, false));
      if (!bands.empty()) drawn["bands"] = std::move(bands);
      const auto toggle = std::find(rendered.toggles.begin(), rendered.toggles.end(), series.toggle);
      if (toggle != rendered.toggles.end()) drawn["toggle"] = toggle - rendered.toggles.begin();
      entry["series"].push_back(drawn);
    }
    document["panels"].push_back(entry);
  }
  std::string safe;
  for (const char c : document.dump(-1, ' ', /*ensure_ascii=*/true))
    safe += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", static_cast<int>(c)) : std::string(1, c);
  safe.insert(1, "\"arrays\":" + arrays.json() + ",");
  return safe;
}

std::string check_box(std::size_t toggle, bool checked) {
  return fmt::format("<input type=\"checkbox\" class=\"c{}\"{}/>", toggle, checked ? " checked=\"checked\"" : "");
}

/// Keys of the labels; a toggle that stands for one label is its check box, the others follow in a row.
std::string legend_html(const Figure& figure, const RenderedFigure& rendered) {
  struct Toggle {
    std::set<std::string> labels;
    bool shown = true;
  };
  std::vector<Toggle> toggles(rendered.toggles.size());
  std::map<std::string, std::set<std::size_t>> toggles_of;  // by label; their count where there is none
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      const auto at = static_cast<std::size_t>(
          std::find(rendered.toggles.begin(), rendered.toggles.end(), series.toggle) - rendered.toggles.begin());
      const std::string label = to_plain(series.label);
      toggles_of[label].insert(at);
      if (at == toggles.size()) continue;
      toggles[at].labels.insert(label);
      toggles[at].shown = !series.initially_hidden;
    }
  }
  std::set<std::size_t> apart;
  for (std::size_t i = 0; i < toggles.size(); ++i) apart.insert(i);
  std::string keys, boxes;
  for (const Series* entry : legend_entries(figure)) {
    const std::set<std::size_t>& own = toggles_of[to_plain(entry->label)];
    const std::string words = fmt::format("<svg class=\"k\" viewBox=\"0 0 24 16\" aria-hidden=\"true\">{}</svg>{}",
                                          legend_key(*entry, 0, 8), to_html(entry->label));
    const std::size_t toggle = own.size() == 1 ? *own.begin() : toggles.size();
    if (toggle == toggles.size()) {
      keys += "<span>" + words + "</span>\n";
    } else if (toggles[toggle].labels.size() > 1) {
      keys += fmt::format("<span class=\"t{}\">{}</span>\n", toggle, words);
    } else {
      keys += "<label>" + check_box(toggle, toggles[toggle].shown) + words + "</label>\n";
      apart.erase(toggle);
    }
  }
  for (const std::size_t i : apart)
    boxes += "<label>" + check_box(i, toggles[i].shown) + to_html(plain(rendered.toggles[i])) + "</label>\n";
  if (!boxes.empty()) boxes = "<div class=\"toggles\"><b>Show:</b>\n" + boxes + "</div>\n";
  return keys.empty() && boxes.empty()
             ? ""
             : fmt::format("<div class=\"legend\" role=\"group\" aria-label=\"Legend of {}\">\n{}{}</div>\n",
                           to_html(plain(figure.title)), keys, boxes);
}

std::string said_of_points(int count, const char* what) {
  return count == 0 ? "" : fmt::format(" {} {}.", count, what);
}

/// Open for what it is drawn from.
std::string caption_html(const std::string& id, const std::string& title, const Text& caption) {
  return fmt::format(
      "<figcaption><a class=\"anchor\" href=\"#{}\" aria-label=\"Link to this figure\">#</a> <b>{}.</b> {} <span "
      "class=\"source\">",
      id, to_html(plain(title)), to_html(caption));
}

/// Of base 64.
char base64_character(unsigned six_bits) {
  return "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[six_bits & 63u];
}

}  // namespace

std::string code_list(const std::vector<std::string>& files) {
  std::string html;
  for (const std::string& file : files)
    html += (html.empty() ? "<code>" : ", <code>") + to_html(plain(file)) + "</code>";
  return html;
}

std::string packed_numbers(const std::vector<double>& values, bool logarithmic) {
  double least = std::numeric_limits<double>::max(), most = 0;
  for (const double value : values) {
    if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  }
  logarithmic = logarithmic || (least > 0 && most > kManyTimes * least);
  const auto number = [=](double value) {
    if (!std::isfinite(value) || (logarithmic && value <= 0)) return std::numeric_limits<double>::quiet_NaN();
    return logarithmic ? std::log(value) : std::clamp(value, -kLargestDrawn, kLargestDrawn);
  };
  double lowest = std::numeric_limits<double>::max(), highest = std::numeric_limits<double>::lowest();
  for (const double value : values) {
    const double v = number(value);
    if (!std::isfinite(v)) continue;
    lowest = std::min(lowest, v);
    highest = std::max(highest, v);
  }
  if (!(lowest <= highest)) lowest = highest = 0;
  std::string text;
  text.reserve(3 * values.size());
  for (const double value : values) {
    const double v = number(value);
    const double share = highest > lowest ? (v - lowest) / (highest - lowest) : 0;
    const unsigned code = std::isfinite(v) ? static_cast<unsigned>(std::lround(share * kLargestCode)) : kUndefinedCode;
    text += {base64_character(code >> 12), base64_character(code >> 6), base64_character(code)};
  }
  return fmt::format("[{:.9g},{:.9g},\"{}\"{}]", lowest, highest, text, logarithmic ? ",1" : "");
}

std::string toggle_style(std::size_t count) {
  std::string style;
  for (std::size_t i = 0; i < count; ++i)
    style += fmt::format("figure:has(.c{0}:not(:checked)) .t{0} {{ display: none; }}\n", i);
  return style;
}

std::string figure_html(const Figure& figure) {
  const RenderedFigure rendered = render(figure);
  std::string html =
      fmt::format("<figure id=\"{}\">\n<p class=\"unseen\">{}</p>\n", figure.id, to_html(plain(figure.description)));
  html += legend_html(figure, rendered) + fmt::format("<div class=\"panels columns{}\">\n", rendered.columns);
  for (const std::string& panel : rendered.panels) html += panel;
  html += "</div>\n" + caption_html(figure.id, figure.title, figure.caption);
  html += said_of_points(rendered.undefined_points, "undefined points are not drawn") +
          said_of_points(rendered.outside_points, "points lie outside the axes") + " Drawn from " +
          code_list(figure.sources) +
          (figure.command.empty() ? "" : ", made by <code>" + to_html(plain(figure.command)) + "</code>") +
          ".</span></figcaption>\n";
  return html + fmt::format("<script type=\"application/json\">{}</script>\n</figure>", figure_data(figure, rendered));
}

std::string drawing_html(const Drawing& drawing) {
  std::string html = fmt::format("<figure id=\"{}\">\n<p class=\"unseen\">{}</p>\n<div class=\"panels columns2\">\n",
                                 drawing.id, to_html(plain(drawing.description)));
  for (const std::string& panel : drawing.panels) html += panel;
  return html + "</div>\n" + caption_html(drawing.id, drawing.title, drawing.caption) + "Drawn from " +
         code_list(drawing.sources) + ".</span></figcaption>\n</figure>";
}

}  // namespace grainlaw::app::report
