#pragma once
// How the rows of shear are read: as states of the law, which of them enter a fit, and from where on they are steady.

#include <vector>

#include "fit/data/options.hpp"
#include "model/evolution.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

/// A row of a test as the law's state: P*, sigma'* = sigma' 2<r>/k and F' (Eqs. (7), (8), (10)), compression positive.
LawState<double> measured_state(const TestRecord& test, const Observation& row);

/// l of D2 is 0, that of D3 1.
bool is_like_D2(double lode);

/// A row with a network that carries. Below, contacts may exist, but P* is less than what any jammed state here has.
bool is_jammed(const Observation& row);

// Windows. Two, whose weight does not depend on how many rows they have: (0, rate_window], which holds the rates, and
// [steady_from, end], whose mean is the limit. The second counts steady_weight times the first: stress ratio and fabric
// overshoot before they settle (by 5 to 10 % in packings of a few thousand), and s_max and F_max are meant to be steady
// means; how they soften is ignored as in the paper. docs/theory/fit.md, section Weights.

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

// Steady state by the marginal standard error rule: the beginning after which the mean is known best is the onset
// (docs/theory/fit.md, section Stages). Rows at equal distances.

/// Row at which `x` becomes steady; -1 when it does not, or has fewer than 8 rows. A jump in the second half of the rows
/// is scatter.
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
