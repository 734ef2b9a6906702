#pragma once
// Likelihood profiles: for parameters of which the standard error says little, how far they can be moved while all others
// of the stage are fitted again, until the cost has risen by what the 95 % interval allows. That is the interval of the
// standard error where the cost is a parabola, and the honest one where it is not: docs/theory/fit.md, section Profiles.

#include <string>

#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

/// Why the parameter's interval is to be profiled; empty when it is not: it is at a bound, not identified, or its interval
/// contains zero.
std::string doubt(const Estimate& estimate);

/// Profiles of the doubtful parameters of `fit`, the solution of `problem`, into its stage. Without any
/// parameter that has an error, or with one parameter alone, there are none.
void profile_doubtful(const Problem& problem, int threads, const RunControl& control, StageFit& fit);

}  // namespace grainlaw::fit
