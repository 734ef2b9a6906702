#pragma once
// Two 95 % bands about a predicted curve, by the slopes of its rows to the parameters and their covariance: where the mean
// over many packings is expected, and where a run of one packing is, wider by the scatter of such runs. Both by Student's t,
// because errors are known from few packings. Formulas: docs/theory/bands.md.

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// A variance and how well it is known.
struct Variance {
  double value = 0;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
};

/// The sum, by weighted degrees of freedom: 1/n = sum_k w_k/n_k / sum_k w_k, w_k the values.
Variance sum_of(const Variance& a, const Variance& b);

/// `law`, the variance that parameters make, with `own`, that of the law's own error from m rehearsals, where that is
/// positive. The sum then has m degrees of freedom at most, however well `law` is known: it is what was measured on m paths,
/// and `own` the part of it that is left.
Variance widened(const Variance& law, double own, double m);

/// What the law knows of its errors, as variances of a row.
class BandMaker {
 public:
  /// `law` must outlive the object.
  explicit BandMaker(const CalibratedLaw& law);

  /// g.V g of a quantity; NaN where slopes end.
  Variance of_law(const std::vector<RowSlope>& slopes, double (*slope)(const RowSlope&)) const;

  /// Standard deviation between runs; NaN where none is known.
  double scatter(double nu, Rehearsed quantity) const;

 private:
  const CalibratedLaw& law_;
  Eigen::MatrixXd covariance_;          // of the uncertain parameters, square
  Eigen::VectorXd degrees_of_freedom_;  // positive, may be infinite
};

/// predict() by `law` and within its range, with the bands of all rows whose slopes are known, by the errors of `law` and its own
/// error from the rehearsals that speak for the path, where there are any. Without scatter between packings there are no bands of a
/// single run. `start_from_law`: as in Sensitivity.
Prediction predict_with_bands(Rung rung, const CalibratedLaw& law, const std::vector<StraightSegment>& segments,
                              const LawState<double>& start, bool start_from_law,
                              const std::vector<OutputPoint>& points, const RunControl& control);

}  // namespace grainlaw::predict
