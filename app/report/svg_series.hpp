#pragma once
// The ink of one series in the frame of its panel: bands, error bars, line and
// symbols, as SVG.

#include <string>

#include "app/report/axis.hpp"
#include "app/report/figure.hpp"

namespace grainlaw::app::report {

/// A length with two decimals at most, e.g. "12.5".
std::string pixels(double value);

/// Axes and their place in the figure [px], without labels.
struct Frame {
  Axis x, y;
  double left = 0, top = 0, width = 0, height = 0;

  /// Position of a value [px]; far outside is as good as just outside, and
  /// keeps the numbers in the file small.
  double px(double value) const;
  double py(double value) const;
};

/// Points that are not seen.
struct Unseen {
  int undefined = 0;  ///< x or y is not finite (or not positive on a logarithmic axis)
  int outside = 0;    ///< symbols beyond the frame
};

/// The series as a <g> element; what is not seen of it is added to `unseen`.
std::string series_svg(const Series& series, const Frame& frame, Unseen& unseen);

/// Its key in a legend, 24 px wide from `x` on.
std::string legend_key(const Series& series, double x, double y);

}  // namespace grainlaw::app::report
