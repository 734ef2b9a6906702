#pragma once
// A figure as plain data: panels in a grid, series in each. What is drawn and how, without any SVG.
// Conventions of this report: DEM = symbols, law = solid lines, published = dashed lines.

#include <optional>
#include <string>
#include <vector>

#include "app/report/text.hpp"

namespace grainlaw::app::report {

enum class Marker { none, circle, square, triangle, diamond, cross, plus, star };
enum class Line { none, solid, dashed, dotted };

/// Colours of the palette by Okabe and Ito, distinguishable for the colour blind; yellow is left out (too pale). Grey is for
/// what matters less, it is none of the count.
enum class Colour { ink, blue, vermillion, green, purple, orange, sky, grey };
inline constexpr int kColourCount = 7;

struct Series {
  Text label;                              ///< entry in the legend, once per figure and label; empty: none
  std::vector<double> x, y;                ///< same length; a point that is not finite is not drawn but counted
  std::vector<double> y_error;             ///< one standard error each, may be empty or NaN
  std::vector<std::vector<double>> bands;  ///< half widths of shaded bands about y, each as long as y; NaN: a gap
  Colour colour = Colour::ink;
  Marker marker = Marker::none;
  bool open_marker = false;  ///< outline only
  double marker_size = 3;    ///< half of its width [px]
  Line line = Line::none;
  double line_width = 1.8;  ///< [px]
  /// Shows and hides it together with others of the figure, e.g. "evolution", "seed 3"; empty: always shown.
  std::string toggle;
  bool initially_hidden = false;  ///< shown once its toggle is chosen; alike in all series of a toggle
};

struct AxisStyle {
  Text label;  ///< quantity, symbol and unit
  bool logarithmic = false;
  std::optional<double> from, to;  ///< shown range; what is not given comes from the data
  std::optional<double> floor;     ///< smaller values do not stretch the range
  std::optional<double> include;   ///< a value that the range must contain, e.g. 0
};

struct Panel {
  Text title;  ///< may be empty
  AxisStyle x, y;
  std::vector<Series> series;
  bool zero_line = false;  ///< a thin line at y = 0
};

struct Figure {
  std::string id;                         ///< letters, digits and '-'; unique in the page
  std::string title;                      ///< for the caption and for screen readers, one line
  std::string description;                ///< what a reader sees, for screen readers
  Text caption = {};                      ///< below the figure
  std::vector<std::string> sources = {};  ///< files that it was drawn from, relative to the report's directory
  std::string command = {};               ///< that made these files; empty: unknown
  std::vector<Panel> panels = {};
  int columns = 1;
  double panel_height = 250;  ///< [px] of a figure 1000 px wide
  bool shared_axes = false;   ///< same ranges in all panels, numbers on the outer ones only
};

/// A picture that is no plot: ready panels, two in a row, without numbers to point at.
struct Drawing {
  std::string id, title, description;  ///< as of a figure
  Text caption;
  std::vector<std::string> sources;
  std::vector<std::string> panels;  ///< <svg class="p"> each
};

}  // namespace grainlaw::app::report
