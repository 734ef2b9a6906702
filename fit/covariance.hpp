#pragma once
// Standard errors of a least-squares fit whose rows are correlated within runs (DEM series are: the naive (J^T J)^-1
// covers a third of what it promises). Cluster-robust sandwich over independent runs c, J and r weighted, H = J^T J:
//   V = H^+ (sum_c g_c g_c^T) H^+,   g_c = J_c^T (1 - J_c H^+ J_c^T)^(-1/2) r_c
// The power of the leverage undoes what a run's own share in the fit takes from its residual ("CR2"). For G runs that
// share alike it is the factor G/(G-1); where a parameter rests on few of many runs (two ISO branches among twenty shear
// tests, for the pressure's nu_c) it is the factor of those few, and correlations stay what they are.
// With few runs the sum has few terms and can vanish in a direction by chance (two runs and three parameters: it must).
// So the plain sum is also made with each run cut into ten pieces in the order of its rows: correlation within a piece
// counts, that between pieces does not. Directions in which that is larger get what is missing.
// Source: Bell & McCaffrey, Survey Methodology 28 (2002) 169; the sandwich is Liang & Zeger, Biometrika 73 (1986) 13.
//
// Identifiability: singular values of J with columns scaled to one. A column that is zero, or takes part in a null
// direction, belongs to a parameter that the rows do not determine.

#include <Eigen/Core>
#include <vector>

namespace grainlaw::fit {

struct ClusterCovariance {
  Eigen::MatrixXd covariance;    ///< V; rows and columns without an error are zero
  std::vector<bool> identified;  ///< per parameter, by the singular values
  std::vector<bool> has_error;   ///< identified, and no single run carries it
  double condition = 0;          ///< largest over smallest singular value of the scaled columns
};

inline constexpr double kNullSingularValue = 1e-7;  ///< relative to the largest; exact derivatives reach 1e-13
inline constexpr double kLargestLeverage = 0.9;     ///< of a run on a direction; beyond, its residual says nothing

/// `jacobian` and `misfit` weighted, rows of zero weight left out; `free` false holds a parameter (at a bound) fixed. Of
/// the rows of a run, `rows_together` at a time stay in one piece.
ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free,
                                     Eigen::Index rows_together = 1);

}  // namespace grainlaw::fit
