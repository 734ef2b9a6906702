#include "predict/bands.hpp"

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::predict {
namespace {

/// A variance and how well it is known.
struct Variance {
  double value = 0, degrees_of_freedom = 0;
};

double half_width(const Variance& v) {
  if (!std::isfinite(v.value)) return v.value;
  return v.value > 0 ? student_95(v.degrees_of_freedom) * std::sqrt(v.value) : 0;
}

/// Of a quantity with slopes `g`.
Variance of_mean(const Uncertainty& uncertainty, const Eigen::VectorXd& g) {
  const Eigen::VectorXd shares = g.cwiseProduct(uncertainty.covariance * g), weights = shares.cwiseAbs();
  return {shares.sum(), weights.sum() / weights.dot(uncertainty.degrees_of_freedom.cwiseInverse())};
}

/// Welch and Satterthwaite.
Variance sum(const Variance& a, const Variance& b) {
  const double both = a.value + b.value;
  const double parts = (a.value > 0 ? a.value * a.value / a.degrees_of_freedom : 0) +
                       (b.value > 0 ? b.value * b.value / b.degrees_of_freedom : 0);
  return {both, both * both / parts};
}

}  // namespace

void add_bands(const LawParameters<double>& parameters, const Uncertainty& uncertainty, Prediction& prediction) {
  struct Quantity {
    double RowBand::*band;
    double (*slope)(const RowSlope&);
    double scatter;
  };
  const RunScatter& scatter = uncertainty.scatter;
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
      const Variance mean = of_mean(uncertainty, g);
      row.mean.*quantity.band = half_width(mean);
      row.single.*quantity.band =
          half_width(sum(mean, {quantity.scatter * quantity.scatter, scatter.degrees_of_freedom}));
    }
  }
}

}  // namespace grainlaw::predict
