#pragma once
// How the minimum of a problem is looked for: by its loss, and from several starts.
//
// Several starts, where a cost may have several minima: the given one, and others around it. Each parameter is multiplied
// by a factor within 1/3 ... 3, uniform in its logarithm; one that starts at zero begins within a third of its scale, a
// jamming density within +-0.005. The lowest cost is kept. The starts are the same in every run.

#include <limits>

#include "fit/statistics/least_squares.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::fit {

/// Where solutions from several starts ended.
struct StartSearch {
  int tried = 1, at_minimum = 1;                                ///< starts; those that ended at the lowest cost
  double next_cost = std::numeric_limits<double>::quiet_NaN();  ///< of the next minimum; NaN: there is none
};
GRAINLAW_FIELDS(StartSearch, tried, at_minimum, next_cost);

/// The best of `starts` (at least 1) solutions of the problem by its loss, and in `search` how many of them ended there.
Solution minimise(const Problem& problem, int starts, int threads, const std::string& stage, const RunControl& control,
                  StartSearch& search);

/// Of the parameters `from`, number `which` (0: as given) of the starts.
std::vector<FreeParameter> start_number(const std::vector<FreeParameter>& from, int which);

}  // namespace grainlaw::fit
