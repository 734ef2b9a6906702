#include "app/report/figure_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::app::report {
namespace {

constexpr double kLawWidth = 1.5;  // [px] from which a line is a law's

bool has_points(const Series& series) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) return true;
  }
  return false;
}

bool is_of_data(const Series& series) {
  return series.marker != Marker::none || (series.line == Line::solid && series.line_width < kLawWidth);
}

bool shows_data(const Panel& panel) {
  const bool lacks = std::ranges::any_of(panel.series, [](const Series& s) { return !has_points(s); });
  return !lacks || std::ranges::any_of(panel.series, [](const Series& s) { return is_of_data(s) && has_points(s); });
}

}  // namespace

Figure with_data(Figure figure) {
  std::vector<std::string> absent;
  std::vector<bool> kept(static_cast<std::size_t>(figure.columns));  // columns of which a panel is left
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const std::string label = to_plain(figure.panels[i].y.label);
    if (shows_data(figure.panels[i]))
      kept[i % kept.size()] = true;
    else if (std::ranges::find(absent, label) == absent.end())
      absent.push_back(label);
  }
  if (absent.empty()) return figure;
  std::erase_if(figure.panels, [](const Panel& panel) { return !shows_data(panel); });
  figure.columns = std::max(1, static_cast<int>(std::ranges::count(kept, true)));
  figure.caption = figure.caption + plain(fmt::format(" The data do not tell: {}.", fmt::join(absent, ", ")));
  return figure;
}

}  // namespace grainlaw::app::report
