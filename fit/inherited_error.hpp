#pragma once
// The error that a stage inherits from parameters of earlier stages that it takes as given, e.g. phi_c of Eq. (12) from nu_c
// of Eq. (11): a little of nu_c is much of phi_c. A packing that moved the given parameters by psi_c moves those of the
// stage by the response of its fit to the change of its misfits,
//   psi_c += -H^+ J^T (d misfit/d given) psi_c(given),
// and what both stages owe to the same packing adds up with its sign.
// Source: two-step M-estimation, Newey & McFadden, Handbook of Econometrics IV (1994), section 6.

#include <functional>

#include "fit/stage_fit.hpp"
#include "model/parameters.hpp"

namespace grainlaw::fit {

/// Errors of the parameters found so far, in the order of parameter_table().
struct FoundErrors {
  Eigen::MatrixXd influence;           ///< kParameterCount x packings; zero where there is no error; empty: none at all
  Eigen::VectorXd degrees_of_freedom;  ///< kParameterCount; NaN where there is no error

  Eigen::MatrixXd covariance() const { return influence * influence.transpose(); }
};
FoundErrors no_errors();

/// Adds columns of zeros for packings that did not take part, up to `packings` columns.
void widen(Eigen::MatrixXd& influence, Eigen::Index packings);

/// Adds to the errors of `second`. `slope`: rows of its misfit x given, `influence`: given x packings. Degrees of freedom:
/// the smallest of its own and `degrees_of_freedom`'s. Nothing changes where the given parameters have no error.
void inherit_error(const Eigen::MatrixXd& slope, const Eigen::MatrixXd& influence,
                   const Eigen::VectorXd& degrees_of_freedom, StageFit& second);

/// Likewise with slopes by difference quotients: `blocks_at(law)` are the blocks of the stage with another law as given,
/// `groups` the parameters to vary, by their names up to the dot.
void inherit_error(const std::vector<std::string>& groups, const FoundErrors& found, const LawParameters<double>& law,
                   const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at,
                   StageFit& second);

}  // namespace grainlaw::fit
