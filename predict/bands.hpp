#pragma once
// Two 95 % bands about a predicted curve, g = d(row)/d(parameters), V the parameters' covariance (delta method):
//   mean curve   half width t_n sqrt(g.V g)
//   single run   half width sqrt(mean's^2 + (t_m s)^2),  s the scatter of runs of one path on different packings
// t_n the 97.5 % quantile of Student's distribution with n degrees of freedom: errors are known from few packings. 1/n is
// the mean of 1/n_k of the parameters, weighted by |g_k (V g)_k|; m is that of s.
// s of P* is that of the volumetric strain times B* of ISO unloading at the row's nu; that of s_dev and F_dev is s_par's
// and F_par's.

#include <Eigen/Core>

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// Standard deviations between packings; NaN where they are not known, then there is no band of a single run.
struct RunScatter {
  double compression = std::numeric_limits<double>::quiet_NaN();         ///< of P*/B* [-]
  double s_par = std::numeric_limits<double>::quiet_NaN();               ///< [-]
  double F_par = std::numeric_limits<double>::quiet_NaN();               ///< [-]
  double degrees_of_freedom = std::numeric_limits<double>::quiet_NaN();  ///< of these [-]
};

/// What is known of the errors of a calibrated law.
struct Uncertainty {
  std::vector<std::size_t> parameters;  ///< indices in parameter_table(): those that have an error; none: no bands
  Eigen::MatrixXd covariance;           ///< of these, square
  Eigen::VectorXd degrees_of_freedom;   ///< of these, positive, may be infinite
  RunScatter scatter;
};

/// Sets the bands of all rows whose slopes are known. `prediction` was made with Sensitivity::parameters those of
/// `uncertainty` and with the law `parameters`.
void add_bands(const LawParameters<double>& parameters, const Uncertainty& uncertainty, Prediction& prediction);

}  // namespace grainlaw::predict
