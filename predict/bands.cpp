#include "predict/bands.hpp"

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::predict {
namespace {

/// What the law knows of its errors: those of the uncertain parameters alone.
struct Errors {
  Eigen::MatrixXd covariance;          ///< square
  Eigen::VectorXd degrees_of_freedom;  ///< positive, may be infinite
};

Errors errors_of(const CalibratedLaw& law) {
  const std::vector<std::size_t> parameters = uncertain_parameters(law);
  Errors errors{law.covariance(parameters, parameters), Eigen::VectorXd(static_cast<Eigen::Index>(parameters.size()))};
  for (std::size_t k = 0; k < parameters.size(); ++k)
    errors.degrees_of_freedom(static_cast<Eigen::Index>(k)) = law.estimates[parameters[k]].degrees_of_freedom;
  return errors;
}

/// Of the mean of a quantity with slopes `g`.
double half_width(const Errors& errors, const Eigen::VectorXd& g) {
  const Eigen::VectorXd shares = g.cwiseProduct(errors.covariance * g), weights = shares.cwiseAbs();
  const double variance = shares.sum();
  if (!std::isfinite(variance)) return variance;
  if (!(variance > 0)) return 0;
  return student_95(weights.sum() / weights.dot(errors.degrees_of_freedom.cwiseInverse())) * std::sqrt(variance);
}

}  // namespace

void add_bands(const CalibratedLaw& law, Prediction& prediction) {
  if (prediction.slopes.empty()) return;
  struct Quantity {
    double RowBand::*band;
    double (*slope)(const RowSlope&);
    double scatter;
  };
  const Errors errors = errors_of(law);
  const PackingScatter& scatter = law.scatter;
  const double of_scatter = scatter.degrees_of_freedom > 0 ? student_95(scatter.degrees_of_freedom)
                                                           : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < prediction.slopes.size(); ++i) {
    PredictedRow& row = prediction.rows[i];
    const std::vector<RowSlope>& slopes = prediction.slopes[i];
    const double B = law.parameters.isotropic.B_star(reference_density(law.parameters, row.nu));
    for (const Quantity& quantity :
         {Quantity{&RowBand::P, [](const RowSlope& s) { return s.state.P; }, scatter.compression * B},
          Quantity{&RowBand::s_dev, [](const RowSlope& s) { return s.s_dev; }, scatter.s_par},
          Quantity{&RowBand::s_par, [](const RowSlope& s) { return s.s_par; }, scatter.s_par},
          Quantity{&RowBand::F_dev, [](const RowSlope& s) { return s.F_dev; }, scatter.F_par},
          Quantity{&RowBand::F_par, [](const RowSlope& s) { return s.F_par; }, scatter.F_par}}) {
      Eigen::VectorXd g(static_cast<Eigen::Index>(slopes.size()));
      for (std::size_t k = 0; k < slopes.size(); ++k) g(static_cast<Eigen::Index>(k)) = quantity.slope(slopes[k]);
      const double mean = half_width(errors, g);
      row.mean.*quantity.band = mean;
      row.single.*quantity.band = std::hypot(mean, of_scatter * quantity.scatter);
    }
  }
}

Prediction predict_with_bands(Rung rung, const CalibratedLaw& law, const std::vector<StraightSegment>& segments,
                              const LawState<double>& start, bool start_from_law,
                              const std::vector<OutputPoint>& points, const RunControl& control) {
  Prediction prediction = predict(rung, law.parameters, law.coupling, segments, start, points, {}, law.range, control,
                                  {uncertain_parameters(law), start_from_law});
  add_bands(law, prediction);
  return prediction;
}

}  // namespace grainlaw::predict
