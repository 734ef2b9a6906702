#include "predict/bands.hpp"

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::predict {
namespace {

/// Of the mean of a quantity with slopes `g`.
double half_width(const Uncertainty& uncertainty, const Eigen::VectorXd& g) {
  const Eigen::VectorXd shares = g.cwiseProduct(uncertainty.covariance * g), weights = shares.cwiseAbs();
  const double variance = shares.sum();
  if (!std::isfinite(variance)) return variance;
  if (!(variance > 0)) return 0;
  return student_95(weights.sum() / weights.dot(uncertainty.degrees_of_freedom.cwiseInverse())) * std::sqrt(variance);
}

}  // namespace

void add_bands(const LawParameters<double>& parameters, const Uncertainty& uncertainty, Prediction& prediction) {
  struct Quantity {
    double RowBand::*band;
    double (*slope)(const RowSlope&);
    double scatter;
  };
  const RunScatter& scatter = uncertainty.scatter;
  const double of_scatter = scatter.degrees_of_freedom > 0 ? student_95(scatter.degrees_of_freedom)
                                                           : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < prediction.slopes.size(); ++i) {
    PredictedRow& row = prediction.rows[i];
    const std::vector<RowSlope>& slopes = prediction.slopes[i];
    const double B = parameters.isotropic.B_star(reference_density(parameters, row.nu));
    for (const Quantity& quantity :
         {Quantity{&RowBand::P, [](const RowSlope& s) { return s.state.P; }, scatter.compression * B},
          Quantity{&RowBand::s_dev, [](const RowSlope& s) { return s.s_dev; }, scatter.s_par},
          Quantity{&RowBand::s_par, [](const RowSlope& s) { return s.s_par; }, scatter.s_par},
          Quantity{&RowBand::F_dev, [](const RowSlope& s) { return s.F_dev; }, scatter.F_par},
          Quantity{&RowBand::F_par, [](const RowSlope& s) { return s.F_par; }, scatter.F_par}}) {
      Eigen::VectorXd g(static_cast<Eigen::Index>(slopes.size()));
      for (std::size_t k = 0; k < slopes.size(); ++k) g(static_cast<Eigen::Index>(k)) = quantity.slope(slopes[k]);
      const double mean = half_width(uncertainty, g);
      row.mean.*quantity.band = mean;
      row.single.*quantity.band = std::hypot(mean, of_scatter * quantity.scatter);
    }
  }
}

}  // namespace grainlaw::predict
