#pragma once
// Several starts, where a cost may have several minima: the given one, and others around it. Each parameter is multiplied
// by a factor within 1/3 ... 3, uniform in its logarithm; one that starts at zero begins within a third of its scale, a
// jamming density within +-0.005. The lowest cost is kept. The starts are the same in every run.

#include "fit/statistics/least_squares.hpp"
#include "fit/outcome.hpp"

namespace grainlaw::fit {

/// Of the parameters `from`, number `which` (0: as given) of the starts.
std::vector<FreeParameter> start_number(const std::vector<FreeParameter>& from, int which);

/// The converged solution of lowest cost, the first one when none is.
Solution best_of(std::vector<Solution> solutions, StartSearch& search);

/// The best of `starts` (at least 1) solutions by `solve_one`, and in `search` how many of the starts ended there.
template <class SolveOne>
Solution solve_from_many(const std::vector<FreeParameter>& parameters, int starts, const SolveOne& solve_one,
                         StartSearch& search) {
  std::vector<Solution> solutions;
  for (int i = 0; i < starts; ++i) solutions.push_back(solve_one(start_number(parameters, i)));
  return best_of(std::move(solutions), search);
}

}  // namespace grainlaw::fit
