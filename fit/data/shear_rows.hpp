#pragma once
// Which rows of a shear segment enter a fit, and with what weight (equations.md 0, fit windows). Two windows, whose weight
// does not depend on how many rows they have: (0, rate_window], which holds the rates, and [steady_from, end], whose mean
// is the limit. The second counts steady_weight times the first: stress ratio and fabric overshoot before they settle (by
// 5 to 10 % in packings of a few thousand), and s_max and F_max are meant to be steady means; how they soften is ignored
// as in the paper.

#include <vector>

#include "fit/data/options.hpp"

namespace grainlaw::fit {

struct RowWeights {
  std::vector<std::size_t> row;  ///< indices of the rows that enter, ascending
  std::vector<double>
      weight;  ///< of each: 1/sqrt(max(rows of its window, kFullWindow)), times steady_weight in the second
};

inline constexpr std::size_t kFullWindow = 20;  ///< a window of fewer rows weighs less, so that no single row rules

/// `eps_dev`: deviatoric strain of each row since the start of the segment; rows at 0 or before are its start.
RowWeights shear_window(const std::vector<double>& eps_dev, const CalibrationOptions& options);

/// All rows after the start, as one window: segments that change the volume have no steady state.
RowWeights whole_window(const std::vector<double>& strain);

}  // namespace grainlaw::fit
