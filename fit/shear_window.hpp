#pragma once
// Which rows of a shear segment enter a fit, and with what weight (equations.md 0, fit windows). Two windows, of equal
// weight however many rows they have: (0, rate_window], which holds the rates, and [steady_from, end], which holds the
// steady values. Softening between and after the peak is ignored as in the paper; without the second window a long test
// would be all steady state, without the first all transient.

#include <vector>

#include "fit/options.hpp"

namespace grainlaw::fit {

struct RowWeights {
  std::vector<std::size_t> row;  ///< indices of the rows that enter, ascending
  std::vector<double> weight;    ///< of each: 1/sqrt(max(rows of its window, kFullWindow))
};

inline constexpr std::size_t kFullWindow = 20;  ///< a window of fewer rows weighs less, so that no single row rules

/// `eps_dev`: deviatoric strain of each row since the start of the segment; rows at 0 or before are its start.
RowWeights shear_window(const std::vector<double>& eps_dev, const CalibrationOptions& options);

/// All rows after the start, as one window: segments that change the volume have no steady state.
RowWeights whole_window(const std::vector<double>& strain);

}  // namespace grainlaw::fit
