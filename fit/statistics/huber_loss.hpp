#pragma once
// Huber's loss in place of squares: a row further from the fit than 1.345 times the scatter of its quantity, its reach, counts
// by its distance and not by its square; and what that does to errors. Formulas and sources: docs/theory/fit.md, section
// Huber's loss.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/statistics/least_squares.hpp"

namespace grainlaw::fit {

/// Solves with Huber's loss; the weights of the result contain its factors. Costs are those of the last factors.
Solution solve_huber(const Problem& problem, int threads, const std::string& stage, const RunControl& control);

/// `pull_slope` of each row on average over where the scatter of the fit moves it, by the `influence` of packings (parameters x
/// packings). At the solution alone it is all or nothing, and where packings differ as a whole all rows that tell a parameter
/// are held at once.
Eigen::VectorXd pull_slopes(const Solution& solution, const Eigen::MatrixXd& influence);

/// What packings move the parameters by through the reach, which is found from their misfits. To be added to `influence`, by
/// which rows scatter; zero where that has no error.
Eigen::MatrixXd influence_of_reach(const std::vector<ResidualBlock>& blocks, const Solution& solution,
                                   const Eigen::MatrixXd& influence);

}  // namespace grainlaw::fit
