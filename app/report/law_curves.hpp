#pragma once
// Curves of the law over a range, as lines of a figure.

#include <algorithm>
#include <utility>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

/// `function` at evenly spaced points of [from, to].
template <class Function>
Series curve(Text label, Colour colour, Line line, double from, double to, const Function& function, int points = 160) {
  Series series;
  series.label = std::move(label);
  series.colour = colour;
  series.line = line;
  for (int i = 0; i <= points; ++i) {
    const double x = from + (to - from) * i / points;
    series.x.push_back(x);
    series.y.push_back(function(x));
  }
  return series;
}

}  // namespace grainlaw::app::report
