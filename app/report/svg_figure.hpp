#pragma once
// A Figure as SVG: axes, ticks, lines, symbols. In the page each panel is an element of its own, so that panels stand side by
// side or below each other as the screen is wide; a file holds all in one, with the legend above (never over data). Colours
// are the page's CSS variables, so that the figure follows light, dark and print.

#include <filesystem>
#include <string>
#include <vector>

#include "app/report/figure.hpp"
#include "app/report/svg_series.hpp"

namespace grainlaw::app::report {

/// Panels of one size.
struct RenderedFigure {
  std::vector<std::string> panels;   ///< <svg> elements, in the order of the figure
  std::vector<Frame> frames;         ///< of each
  double width = 0, height = 0;      ///< of a panel [px]
  int columns = 1;                   ///< side by side where there is room
  std::vector<std::string> toggles;  ///< of its series, each once; the i-th hides what is of class "t<i>"
  int undefined_points = 0;          ///< left out because x or y is not finite (or not positive on a logarithmic axis)
  int outside_points = 0;            ///< symbols beyond a range that the figure fixes
};

RenderedFigure render(const Figure& figure);

/// What a legend shows: the first series of each label.
std::vector<const Series*> legend_entries(const Figure& figure);

/// The figure as one <svg> element, as it is shown at first.
std::string figure_svg(const Figure& figure);

/// The same as a file of its own, in the colours of the page; light ones in viewers without CSS variables.
void write_svg(const std::filesystem::path& file, const Figure& figure);

}  // namespace grainlaw::app::report
