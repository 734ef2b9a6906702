#pragma once
// Two 95 % bands about a predicted curve, by the slopes of its rows to the parameters and their covariance: where the mean
// over many packings is expected, and where a run of one packing is, wider by the scatter of such runs. Both by Student's t,
// because errors are known from few packings. Formulas: docs/theory/bands.md.

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
