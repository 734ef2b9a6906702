#pragma once
// An axis of a figure: the range that holds the data, round ticks, the way from
// a value to a length.

#include <string>
#include <vector>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

inline constexpr double kLargestDrawn = 1e300;  ///< values are drawn at most there, so that their extent is finite

struct Tick {
  double value = 0;
  Text label;  ///< empty on minor ticks
};

struct Axis {
  bool logarithmic = false;
  double from = 0,
         to = 1;            ///< shown range, from < to; both positive when logarithmic
  std::vector<Tick> ticks;  ///< ascending, within the range

  /// Position of `value` from 0 (at `from`) to 1 (at `to`); beyond that outside
  /// of the range.
  double fraction(double value) const;
  /// Finite, positive when logarithmic.
  bool defined_at(double value) const;
};

/// Axis around [lowest, highest] with a small margin and about `wanted` ticks
/// at 1, 2 or 5 times a power of ten; a range without extent is widened. With
/// `exact` the range is taken as it is.
Axis linear_axis(double lowest, double highest, int wanted = 5, bool exact = false);

/// Logarithmic axis over whole decades around [lowest, highest] > 0, ticks at
/// powers of ten.
Axis logarithmic_axis(double lowest, double highest, int wanted = 6);

/// The axis of all of `panels`, at least one, styled as in the first: it holds
/// their points, error bars and bands.
Axis shared_axis(const std::vector<const Panel*>& panels, bool horizontal, int wanted);

}  // namespace grainlaw::app::report
