#pragma once
// The error that a stage inherits from parameters of earlier stages that it takes as given, e.g. phi_c of Eq. (12) from nu_c
// of Eq. (11): a little of nu_c is much of phi_c. A packing that moved the given parameters moves those of the stage by the
// response of its fit, and what both stages owe to the same packing adds up with its sign: docs/theory/fit.md, section
// Inherited errors.

#include <functional>

#include "fit/statistics/stage_fit.hpp"
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

/// Takes over what a stage says of its parameters in place of what earlier ones said.
void add_errors(const StageFit& fit, FoundErrors& found);

/// Adds to the errors of `second` what it owes to the parameters `given`, names or groups (names up to the dot), by the change
/// of its gradient, in difference quotients along each packing's influence. `blocks_at(law)`: the blocks of the stage with
/// another law as given. Degrees of freedom: the smallest of its own and theirs. Nothing changes where they have no error.
void inherit_errors(const std::vector<std::string>& given, const FoundErrors& found, const LawParameters<double>& law,
                    const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at,
                    int threads, StageFit& second);

}  // namespace grainlaw::fit
