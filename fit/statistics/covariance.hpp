#pragma once
// Standard errors of a least-squares fit of rows that are not independent. Packings are the unit of chance: rows of one run
// are correlated, and runs of one packing share the packing (the naive (J^T J)^-1 covers a third of what it promises).
// V = sum_c psi_c psi_c^T over packings c, psi_c the influence of packing c: what it moved the parameters by. From few
// packings V itself is uncertain, so that an interval reaches over Student's t of some degrees of freedom. Formulas and
// sources: docs/theory/fit.md, sections Covariance over packings and Degrees of freedom.
//
// J is the Jacobian, weighted; H = J^T J; A = H + S the Hessian of the cost, S by the misfits (curvature()). Identifiability:
// by the singular values of J with columns scaled to one. A column that is zero, or takes part in a null direction, belongs
// to a parameter that the rows do not determine.

#include <Eigen/Core>
#include <vector>

namespace grainlaw::fit {

struct ClusterCovariance {
  Eigen::MatrixXd influence;           ///< parameters x packings; rows without an error are zero
  Eigen::VectorXd degrees_of_freedom;  ///< per parameter; NaN without an error
  std::vector<bool> identified;        ///< per parameter, by the singular values
  std::vector<bool> has_error;         ///< identified, and no single packing carries it

  Eigen::MatrixXd covariance() const { return influence * influence.transpose(); }
};

inline constexpr double kNullSingularValue = 1e-7;  ///< relative to the largest; exact derivatives reach 1e-13
inline constexpr double kLargestLeverage = 0.9;     ///< of a packing on a direction; beyond, its residual says nothing

/// `jacobian` and `misfit` weighted, rows of zero weight left out; `free` false holds a parameter (at a bound) fixed.
/// `cluster` of each row: its packing, numbered from 0. `curvature`: S, parameters x parameters; empty: none.
ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free,
                                     const Eigen::MatrixXd& curvature = {});

/// By how much the free parameters move when the gradient of the cost, J^T misfit, changes by the columns of `change`:
/// -A^+ change. Parameters x columns.
Eigen::MatrixXd response(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free, const Eigen::MatrixXd& change,
                         const Eigen::MatrixXd& curvature = {});

/// Diagonal of A^+: without curvature, variances were rows independent and of unit variance; 1/A^+_kk is the second
/// derivative of the profile of the cost over parameter k. Zero for parameters that are not free.
Eigen::VectorXd naive_variance(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free,
                               const Eigen::MatrixXd& curvature = {});

}  // namespace grainlaw::fit
