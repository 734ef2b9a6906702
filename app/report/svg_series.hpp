#pragma once
// The ink of one series in the frame of its panel: bands, error bars, line and symbols, as SVG.

#include <string>
#include <vector>

#include "app/report/axis.hpp"
#include "app/report/figure.hpp"

namespace grainlaw::app::report {

/// A length with two decimals at most, e.g. "12.5".
std::string pixels(double value);

/// Axes and their place in the panel [px], without labels.
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

/// The symbols of a figure, each drawn once and set at every point by reference.
class Symbols {
 public:
  /// `figure`: its id, which begins theirs.
  explicit Symbols(std::string figure) : figure_(std::move(figure)) {}
  /// The id of the symbol of `series`, which has one.
  std::string id_of(const Series& series);
  /// All that were asked for, as a <defs> element.
  std::string definitions() const;

 private:
  std::string figure_;
  std::vector<std::string> symbols_;
};

/// The series as a <g> element of class "s"; in it, in this order, a path "b" for each band, "e" for the error bars, "l" for the
/// line, "m" for the symbols. `toggle`: class by which it is hidden, may be empty. What is not seen is added to `unseen`.
std::string series_svg(const Series& series, const std::string& toggle, const Frame& frame, Symbols& symbols,
                       Unseen& unseen);

/// Its key in a legend, 24 px wide from `x` on.
std::string legend_key(const Series& series, double x, double y);

}  // namespace grainlaw::app::report
