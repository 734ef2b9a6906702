#pragma once
// What J^T W^2 J leaves out of the Hessian of the cost: where the model does not meet the data, its misfits bend the cost, and rows
// whose pull Huber's loss holds do not bend it (p_i: Solution::pull_slope).
//   S = sum_i w_i^2 (misfit_i d2 misfit_i/dx2 - (1 - p_i) d misfit_i/dx d misfit_i/dx)
// Without it the error of a parameter of a law that does not hold exactly comes out wrong: those of Eq. (20) for the rates of
// Eq. (16) were 1.6 times too large on data with memory (docs/validation-log.md).

#include "fit/statistics/least_squares.hpp"

namespace grainlaw::fit {

/// S at the solution, by forward differences of the exact Jacobian, to about 1e-6 of it. Rows and columns of parameters at a
/// bound, or where the model is not defined next to the solution, are zero. Costs a Jacobian for each parameter.
Eigen::MatrixXd curvature(const std::vector<FreeParameter>& parameters, const std::vector<ResidualBlock>& blocks,
                          const Solution& solution, int threads);

}  // namespace grainlaw::fit
