#pragma once
// A Figure as an inline SVG element: axes, ticks, lines, symbols, one legend
// above the panels (never over data). Colours are the page's CSS variables, so
// that the figure follows light, dark and print.

#include <filesystem>
#include <string>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

struct RenderedFigure {
  std::string svg;
  int undefined_points = 0;  ///< left out because x or y is not finite (or not
                             ///< positive on a logarithmic axis)
  int outside_points = 0;    ///< symbols beyond a range that the figure fixes
};

RenderedFigure render_svg(const Figure& figure);

/// The figure as a file of its own, in the colours of the page; light ones in
/// viewers without CSS variables.
void write_svg(const std::filesystem::path& file, const Figure& figure);

}  // namespace grainlaw::app::report
