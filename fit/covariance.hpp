#pragma once
// Standard errors of a least-squares fit whose rows are correlated within runs (DEM series are: the naive (J^T J)^-1
// covers a third of what it promises). Cluster-robust sandwich over independent runs c, J and r weighted:
//   H = J^T J,   V0 = H^+ (sum_c g_c g_c^T) H^+,   g_c = J_c^T r_c
//   V_ij = V0_ij sqrt(f_i f_j) (n-1)/(n-p),   f_i = G_i/(G_i-1),   G_i = 1/sum_c h_ci^2
// with h_ci = (H^+ J_c^T J_c H^+)_ii/(H^+)_ii the share of run c in what is known of parameter i. G_i, the effective
// number of runs, takes the place of the plain number because a parameter may rest on few of many runs: two ISO branches
// among twenty shear tests are two runs for the pressure's nu_c.
// With few runs the sum has few terms and can vanish in a direction by chance (two runs and three parameters: it must).
// So the same estimate is made with each run cut into ten pieces in the order of its rows, and a variance that is larger
// there is taken from there: the diagonal of V is the larger of the two.
// Sources: Liang & Zeger 1986; the factor G/(G-1) (n-1)/(n-p) is the usual small-sample correction.
//
// Identifiability: singular values of J with columns scaled to one. A column that is zero, or takes part in a null
// direction, belongs to a parameter that the rows do not determine.

#include <Eigen/Core>
#include <vector>

namespace grainlaw::fit {

struct ClusterCovariance {
  Eigen::MatrixXd covariance;      ///< V; rows and columns without an error are zero
  Eigen::VectorXd effective_runs;  ///< G_i; 0 where not identified
  std::vector<bool> identified;    ///< per parameter, by the singular values
  std::vector<bool> has_error;     ///< identified, G_i > 1.5 and n > p: V_ii means something
  double condition = 0;            ///< largest over smallest singular value of the scaled columns
};

inline constexpr double kNullSingularValue = 1e-7;  ///< relative to the largest; exact derivatives reach 1e-13
inline constexpr double kLeastEffectiveRuns = 1.5;

/// `jacobian` and `misfit` weighted, rows of zero weight left out; `free` false holds a parameter (at a bound) fixed.
ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free);

}  // namespace grainlaw::fit
