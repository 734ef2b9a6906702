#pragma once
// The error that a stage inherits from a parameter of an earlier stage that it takes as given, e.g. phi_c of Eq. (12) from
// nu_c of Eq. (11): a little of nu_c is much of phi_c. Two-step estimation is the limit of a joint fit in which the rows
// of the first stage weigh so much that those of the second do not move its parameters; the errors are those of that fit.
// Source: two-step M-estimation, Newey & McFadden, Handbook of Econometrics IV (1994), section 6.

#include "fit/stage_fit.hpp"

namespace grainlaw::fit {

/// Replaces the errors in `second`. `slope`: d misfit/d parameter for each of its rows, `parameter` being that of `first`
/// which it takes as given. Nothing changes where `first` has no error for it.
void inherit_error(const StageFit& first, const std::string& parameter, const Eigen::VectorXd& slope, StageFit& second);

}  // namespace grainlaw::fit
