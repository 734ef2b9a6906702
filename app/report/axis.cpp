#include "app/report/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::app::report {
namespace {

/// The step 1, 2 or 5 times a power of ten that divides `extent` into about
/// `wanted` parts.
double round_step(double extent, int wanted) {
  const double raw = extent / std::max(1, wanted);
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double mantissa = raw / decade;
  const double round = mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10;
  return round * decade;
}

std::string tick_number(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  if (decimals > 5 || std::abs(value) >= 1e6) return fmt::format("{:g}", value);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-') text.replace(0, 1, "\u2212");
  return text;
}

/// Smallest and largest defined value along one axis of panels.
struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();

  void add(double value, const AxisStyle& style) {
    if (!std::isfinite(value) || (style.logarithmic && value <= 0)) return;
    if (style.floor && value < *style.floor) return;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

Extent extent_of(const std::vector<const Panel*>& panels, bool horizontal, const AxisStyle& style) {
  Extent extent;
  for (const Panel* panel : panels) {
    for (const Series& series : panel->series) {
      const auto& values = horizontal ? series.x : series.y;
      for (std::size_t i = 0; i < values.size(); ++i) {
        // What is not drawn must not stretch the axis.
        if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
        extent.add(values[i], style);
        if (horizontal) continue;
        const auto add_both = [&](double half_width) {
          extent.add(values[i] - half_width, style);
          extent.add(values[i] + half_width, style);
        };
        if (i < series.y_error.size()) add_both(series.y_error[i]);
        for (const std::vector<double>& band : series.bands) add_both(band[i]);
      }
    }
  }
  if (style.include) extent.add(*style.include, style);
  if (!(extent.lowest <= extent.highest)) return style.logarithmic ? Extent{0.1, 1} : Extent{0, 1};
  return extent;
}

}  // namespace

double Axis::fraction(double value) const {
  return logarithmic ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
}

bool Axis::defined_at(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }

Axis linear_axis(double lowest, double highest, int wanted, bool exact) {
  Axis axis;
  lowest = std::clamp(lowest, -kLargestDrawn, kLargestDrawn);
  highest = std::clamp(highest, -kLargestDrawn, kLargestDrawn);
  if (!(highest - lowest > 1e-12 * std::max(std::abs(lowest), std::abs(highest)))) {
    const double half = lowest == 0 ? 1 : 0.1 * std::abs(lowest);
    highest = lowest + half;
    lowest -= half;
  }
  const double margin = exact ? 0 : 0.04 * (highest - lowest);
  axis.from = lowest - margin;
  axis.to = highest + margin;
  const double step = round_step(axis.to - axis.from, wanted);
  const double slack = 1e-9 * (axis.to - axis.from);
  for (double k = std::ceil((axis.from - slack) / step); k * step <= axis.to + slack; ++k) {
    const double value = k == 0 ? 0 : k * step;  // no negative zero
    axis.ticks.push_back({value, plain(tick_number(value, step))});
  }
  return axis;
}

Axis logarithmic_axis(double lowest, double highest, int wanted) {
  Axis axis;
  axis.logarithmic = true;
  const int first = static_cast<int>(std::floor(std::log10(lowest) + 1e-9));
  int last = static_cast<int>(std::ceil(std::log10(highest) - 1e-9));
  last = std::max(last, first + 1);
  axis.from = std::pow(10.0, first);
  axis.to = std::pow(10.0, last);
  const int stride = std::max(1, (last - first + wanted - 1) / wanted);
  for (int decade = first; decade <= last; ++decade) {
    const bool labelled = (decade - first) % stride == 0;
    Text label;
    if (labelled) {
      std::string exponent = std::to_string(decade);
      if (decade < 0) exponent.replace(0, 1, "\u2212");
      label = {{{"10", TextRun::Style::upright}, {exponent, TextRun::Style::superscript}}};
    }
    axis.ticks.push_back({std::pow(10.0, decade), label});
    if (stride > 1 || decade == last) continue;
    for (int k = 2; k <= 9; ++k) axis.ticks.push_back({k * std::pow(10.0, decade), {}});
  }
  return axis;
}

Axis shared_axis(const std::vector<const Panel*>& panels, bool horizontal, int wanted) {
  const AxisStyle& style = horizontal ? panels.front()->x : panels.front()->y;
  const Extent extent = extent_of(panels, horizontal, style);
  const double lowest = style.from.value_or(extent.lowest), highest = style.to.value_or(extent.highest);
  if (style.logarithmic) return logarithmic_axis(lowest, highest, wanted);
  if (style.from && style.to) return linear_axis(lowest, highest, wanted, true);
  Axis axis = linear_axis(lowest, highest, wanted);
  if (style.from || style.to) {
    axis = linear_axis(style.from.value_or(axis.from), style.to.value_or(axis.to), wanted, true);
  }
  return axis;
}

}  // namespace grainlaw::app::report
