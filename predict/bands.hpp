#pragma once
// Two 95 % bands about a predicted curve, g = d(row)/d(parameters), V the parameters' covariance (delta method):
//   mean curve   half width t_n sqrt(g.V g)
//   single run   half width sqrt(mean's^2 + (t_m s)^2),  s the scatter of runs of one path on different packings
// t_n the 97.5 % quantile of Student's distribution with n degrees of freedom: errors are known from few packings. 1/n is
// the mean of 1/n_k of the parameters, weighted by |g_k (V g)_k|; m is that of s.
// s of P* is that of the volumetric strain times B* of ISO unloading at the row's nu; that of s_dev and F_dev is s_par's
// and F_par's.

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// Sets the bands of all rows whose slopes are known, by the errors of `law`. `prediction` was made by this law and with
/// Sensitivity::parameters its uncertain_parameters(). Without scatter between packings there are no bands of a single run.
void add_bands(const CalibratedLaw& law, Prediction& prediction);

/// predict() by `law` and within its range, with bands. `start_from_law`: as in Sensitivity.
Prediction predict_with_bands(Rung rung, const CalibratedLaw& law, const std::vector<StraightSegment>& segments,
                              const LawState<double>& start, bool start_from_law,
                              const std::vector<OutputPoint>& points, const RunControl& control);

}  // namespace grainlaw::predict
