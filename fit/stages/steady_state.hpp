#pragma once
// From where on a series is steady: the marginal standard error rule. Of all beginnings d in the first half of the rows the
// one after which the mean is known best,
//   d* = argmin_d  sum_(i >= d) (x_i - mean_(i >= d))^2/(n - d)^2,
// is the onset: earlier rows belong to the transient, and to leave out more would only shorten the mean. A series whose
// minimum lies at the end of the search goes on changing; a jump in the second half of the rows is scatter to it. Rows at
// equal distances.
// Source: White, Simulation 69 (1997) 323.

#include <vector>

#include "fit/data/options.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

/// Row at which `x` becomes steady; -1 when it does not, or has fewer than 8 rows.
int steady_row(const std::vector<double>& x);

/// Deviatoric strains since the start of a test of shear at constant volume at which its quantities become steady; NaN
/// where they do not.
struct SteadyOnset {
  double s = 0, F = 0, P = 0;

  /// From where steady means are taken: `least`, or the latest of the onsets.
  double from(double least) const;
};
SteadyOnset steady_onset(const TestRecord& test);

}  // namespace grainlaw::fit
