#pragma once
// The ink of one series: symbols, lines and error bars as SVG paths in pixel coordinates.

#include <string>
#include <vector>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

struct PixelPoint {
  double x = 0, y = 0;
  double y_low = 0, y_high = 0;  ///< ends of the error bar, or edges of the band; equal when there is none
};

/// A length with two decimals at most, e.g. "12.5".
std::string pixels(double value);

/// CSS class of a colour: "k0" ... "k7".
std::string colour_class(Colour colour);

/// Path data of a symbol of half width `size` around each point.
std::string marker_path(Marker marker, double size, const std::vector<PixelPoint>& points);

/// Attributes of a symbol's path: filled, or outline for open symbols and crosses.
std::string marker_attributes(Marker marker, bool open);

/// Path data through runs of points; a new run starts after each undefined point.
std::string line_path(const std::vector<std::vector<PixelPoint>>& runs);

std::string line_attributes(Line line, double width);

/// Path data of the areas between y_low and y_high along runs of points.
std::string band_path(const std::vector<std::vector<PixelPoint>>& runs);

/// Path data of the error bars, with caps; empty when there are none.
std::string error_bar_path(const std::vector<PixelPoint>& points);

}  // namespace grainlaw::app::report
