#pragma once
// Likelihood profiles: for parameters of which the standard error says little, how far they can be moved while all others
// of the stage are fitted again. With C(x_k) the cost so refitted, V_kk the variance that covariance.hpp states and H the
// normal matrix,
//   D(x_k) = 2 (C(x_k) - C_min) (H^+)_kk/V_kk  <=  t^2,   t Student's 97.5 % quantile,
// is the 95 % interval: that of the standard error where the cost is a parabola, and the honest one where it is not. Rows are
// not independent; V_kk/(H^+)_kk is what that costs. A parameter without V_kk takes the mean of the stage's others.
// Source: Venzon & Moolgavkar, Applied Statistics 37 (1988) 87; scaled as by Kent, Biometrika 69 (1982) 19.

#include <string>
#include <vector>

#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

/// Why the parameter's interval is to be profiled; empty when it is not: it is at a bound, not identified, or its interval
/// contains zero.
std::string doubt(const Estimate& estimate);

/// Profiles of the doubtful parameters of `fit`, the solution of `parameters` and `blocks`, into its stage. Without any
/// parameter that has an error, or with one parameter alone, there are none.
void profile_doubtful(const std::vector<FreeParameter>& parameters, const std::vector<ResidualBlock>& blocks,
                      int threads, const RunControl& control, StageFit& fit);

}  // namespace grainlaw::fit
