#include "predict/bands.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/student.hpp"

namespace grainlaw::predict {
namespace {

struct Banded {
  Rehearsed error;  ///< whose unit and scatter it has
  double RowBand::*band;
  double (*slope)(const RowSlope&);
};
constexpr std::array<Banded, 5> kBanded{
    {{Rehearsed::P_star, &RowBand::P, [](const RowSlope& s) { return s.state.P; }},
     {Rehearsed::s_par, &RowBand::s_dev, [](const RowSlope& s) { return s.s_dev; }},
     {Rehearsed::s_par, &RowBand::s_par, [](const RowSlope& s) { return s.s_par; }},
     {Rehearsed::F_par, &RowBand::F_dev, [](const RowSlope& s) { return s.F_dev; }},
     {Rehearsed::F_par, &RowBand::F_par, [](const RowSlope& s) { return s.F_par; }}}};

double half_width(const Variance& variance) {
  if (!std::isfinite(variance.value)) return variance.value;
  return variance.value > 0 ? student_95(variance.degrees_of_freedom) * std::sqrt(variance.value) : 0;
}

}  // namespace

Variance sum_of(const Variance& a, const Variance& b) {
  if (!(b.value > 0)) return a;
  if (!(a.value > 0)) return {a.value + b.value, b.degrees_of_freedom};  // NaN stays NaN
  return {a.value + b.value, (a.value + b.value) / (a.value / a.degrees_of_freedom + b.value / b.degrees_of_freedom)};
}

Variance widened(const Variance& law, double own, double m) {
  if (!(own > 0)) return law;
  const Variance sum = sum_of(law, {own, m});
  return {sum.value, std::min(m, sum.degrees_of_freedom)};
}

BandMaker::BandMaker(const CalibratedLaw& law) : law_(law) {
  const std::vector<std::size_t> parameters = uncertain_parameters(law);
  covariance_ = law.covariance(parameters, parameters);
  degrees_of_freedom_.resize(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k)
    degrees_of_freedom_(static_cast<Eigen::Index>(k)) = law.estimates[parameters[k]].degrees_of_freedom;
}

Variance BandMaker::of_law(const std::vector<RowSlope>& slopes, double (*slope)(const RowSlope&)) const {
  Eigen::VectorXd g(static_cast<Eigen::Index>(slopes.size()));
  for (std::size_t k = 0; k < slopes.size(); ++k) g(static_cast<Eigen::Index>(k)) = slope(slopes[k]);
  const Eigen::VectorXd shares = g.cwiseProduct(covariance_ * g), weights = shares.cwiseAbs();
  Variance variance{shares.sum()};
  if (variance.value > 0) variance.degrees_of_freedom = weights.sum() / weights.dot(degrees_of_freedom_.cwiseInverse());
  return variance;
}

double BandMaker::scatter(double nu, Rehearsed quantity) const {
  const PackingScatter& scatter = law_.scatter;
  return quantity == Rehearsed::P_star  ? scatter.compression * error_units(law_.parameters, nu).B
         : quantity == Rehearsed::s_par ? scatter.s_par
                                        : scatter.F_par;
}

Prediction predict_with_bands(Rung rung, const CalibratedLaw& law, const std::vector<StraightSegment>& segments,
                              const LawState<double>& start, bool start_from_law,
                              const std::vector<OutputPoint>& points, const RunControl& control) {
  const BandMaker bands(law);
  const Spokesmen spokesmen = spokesmen_for(segments, law.rehearsals);
  std::array<LawError, 3> errors;
  for (const Rehearsed quantity : kValues<Rehearsed>)
    errors[static_cast<std::size_t>(quantity)] = law_error(spokesmen, rung, quantity);
  const double of_scatter = law.scatter.degrees_of_freedom > 0 ? student_95(law.scatter.degrees_of_freedom)
                                                               : std::numeric_limits<double>::quiet_NaN();
  const auto set_bands = [&](PredictedRow& row, const std::vector<RowSlope>& slopes) {
    const ErrorUnits units = error_units(law.parameters, row.nu);
    for (const Banded& banded : kBanded) {
      const LawError& error = errors[static_cast<std::size_t>(banded.error)];
      Variance variance = bands.of_law(slopes, banded.slope);
      variance = widened(variance, std::pow(units.of(banded.error) * error.tau, 2), error.degrees_of_freedom);
      row.mean.*banded.band = half_width(variance);
      row.single.*banded.band = std::hypot(row.mean.*banded.band, of_scatter * bands.scatter(row.nu, banded.error));
    }
  };
  return predict(rung, law.parameters, law.coupling, segments, start, points, {}, law.range, control,
                 {uncertain_parameters(law), start_from_law, set_bands});
}

}  // namespace grainlaw::predict
