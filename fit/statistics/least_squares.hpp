#pragma once
// Bounded nonlinear least squares: min_x 1/2 sum_i (w_i (model_i(x) - data_i))^2, lower <= x <= upper, by Ceres's trust
// region with dense QR. Blocks are evaluated by several threads, each into its own rows, and everything that is summed
// is summed by one thread in a fixed order: the digits do not depend on the number of threads.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/statistics/problem.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::fit {

struct Solution {
  Eigen::VectorXd x;
  std::vector<bool> at_bound;  ///< per parameter
  Eigen::VectorXd misfit;      ///< model - data of all rows of all blocks in order, unweighted
  Eigen::VectorXd weight;      ///< of these rows
  Eigen::VectorXd
      reach;  ///< of these rows: w |misfit| without the loss's factor, beyond which Huber's loss holds the pull
  Eigen::VectorXd pull_slope;  ///< of these rows: d(w^2 misfit) over w^2 d misfit; 1 but for Huber's loss
  Eigen::MatrixXd jacobian;    ///< d misfit/dx
  Eigen::MatrixXd curvature;   ///< curvature(), set by fit_stage
  std::vector<int> cluster;    ///< of these rows
  double initial_cost = 0, final_cost = 0;
  int iterations = 0;
  std::string termination;  ///< Ceres's word and message
  bool defined = false;     ///< misfit and jacobian are finite at x
  bool converged = false;   ///< by Ceres's word and by the gradient, see .cpp
  double seconds = 0;
};

/// How long is searched: rounds, between which parameters are taken out or let go at their bounds, of so many iterations.
struct SolverEffort {
  int rounds = 60, iterations = 8;
};

/// The least squares of the problem, whatever its loss. A problem that cannot be evaluated at its start, or is solved badly, returns with converged = false and says so in
/// `termination`. Throws Interrupted.
Solution solve(const Problem& problem, int threads, const std::string& stage, const RunControl& control,
               const SolverEffort& effort = {});

/// What J^T W^2 J leaves out of the Hessian of the cost at the solution: misfits of a model that does not hold exactly bend
/// the cost, and rows that Huber's loss holds do not (docs/theory/fit.md, section Covariance over packings). Parameters x
/// parameters, by forward differences of the exact Jacobian, to about 1e-6 of it. Rows and columns of parameters at a bound, or
/// where the model is not defined next to the solution, are zero. Costs a Jacobian for each parameter.
Eigen::MatrixXd curvature(const Problem& problem, const Solution& solution, int threads);

}  // namespace grainlaw::fit
