#include "chain/studies/law_quantities.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "dem/runs/spec_file.hpp"
#include "predict/predict.hpp"
#include "predict/segment_sensitivity.hpp"

namespace grainlaw::chain {
namespace {

constexpr int kStudyPoints = 100;

using Law = LawParameters<double>;

/// A number that the law makes of its parameters, and the groups of parameters that it reads.
struct LawQuantity {
  std::string name;
  std::vector<const char*> groups;
  std::function<double(const Law&)> of;
};

std::vector<LawQuantity> quantities_at(const std::vector<double>& densities) {
  std::vector<LawQuantity> all;
  for (const double nu : densities) {
    const std::string at = "@" + dem::density_text(nu);
    all.push_back({"P_star" + at, {"coordination", "rattlers", "pressure"}, [nu](const Law& law) {
                     return law.isotropic.P_star(nu);
                   }});
    all.push_back(
        {"C_star" + at, {"coordination"}, [nu](const Law& law) { return law.isotropic.coordination.C_star(nu); }});
    const auto add_shear = [&](const char* name, const char* group, ExponentialLaw<double> Law::*Q) {
      all.push_back({name + at, {group}, [nu, Q](const Law& law) { return (law.*Q).value(nu, law.shear_nu_c); }});
    };
    add_shear("s_max", "stress_ratio_max", &Law::stress_ratio_max);
    add_shear("beta_s", "stress_rate", &Law::stress_rate);
    add_shear("F_max", "fabric_max", &Law::fabric_max);
    add_shear("beta_F", "fabric_rate", &Law::fabric_rate);
  }
  all.push_back({"nu_c", {"pressure"}, [](const Law& law) { return law.isotropic.pressure.nu_c; }});
  return all;
}

/// Rows of the parameters that have an error, padded to all packings.
Eigen::MatrixXd influence_of(const fit::Calibration& calibration, const std::vector<std::size_t>& parameters,
                             std::size_t packings) {
  Eigen::MatrixXd influence = calibration.errors.influence;
  fit::widen(influence, static_cast<Eigen::Index>(packings));
  return influence(parameters, Eigen::all);
}

}  // namespace

std::vector<StudyQuantity> law_quantities(const fit::Calibration& calibration, const std::vector<double>& densities,
                                          std::size_t packings) {
  const std::vector<std::size_t> parameters = uncertain_parameters(calibration.law);
  const Eigen::MatrixXd influence = influence_of(calibration, parameters, packings);
  const std::vector<predict::ParameterStep> steps = predict::parameter_steps(calibration.law.parameters, parameters);
  std::vector<StudyQuantity> quantities;
  for (const LawQuantity& q : quantities_at(densities)) {
    double value = q.of(calibration.law.parameters);
    for (const char* group : q.groups) {
      if (!has_values(calibration.law, group)) value = std::numeric_limits<double>::quiet_NaN();
    }
    Eigen::RowVectorXd slope(static_cast<Eigen::Index>(steps.size()));
    for (std::size_t k = 0; k < steps.size(); ++k)
      slope(static_cast<Eigen::Index>(k)) = (q.of(steps[k].above) - q.of(steps[k].below)) / (2 * steps[k].h);
    quantities.push_back({q.name, Eigen::VectorXd::Constant(1, value), slope * influence, q.name != "nu_c"});
  }
  return quantities;
}

std::vector<StudyQuantity> predicted_quantities(const fit::Calibration& calibration, const Path& path, Rung rung,
                                                std::size_t packings, const RunControl& control) {
  const std::vector<std::size_t> parameters = uncertain_parameters(calibration.law);
  const Eigen::MatrixXd influence = influence_of(calibration, parameters, packings);
  const auto segments = resolve(path);
  const predict::Prediction prediction =
      predict::predict(rung, calibration.law.parameters, calibration.law.coupling, segments,
                       predict::state_from_law(calibration.law.parameters, path.nu),
                       predict::uniform_points(segments, kStudyPoints), {}, {}, control, {parameters, true});
  const auto along = [&](const char* name, auto value, auto slope) {
    const auto rows = static_cast<Eigen::Index>(prediction.rows.size());
    StudyQuantity quantity{name, Eigen::VectorXd(rows), Eigen::MatrixXd(rows, influence.cols()), true};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto at = static_cast<std::size_t>(i);
      quantity.values(i) = value(prediction.rows[at]);
      Eigen::RowVectorXd slopes(influence.rows());
      for (Eigen::Index k = 0; k < slopes.size(); ++k)
        slopes(k) = slope(prediction.slopes[at][static_cast<std::size_t>(k)]);
      quantity.influence.row(i) = slopes * influence;
    }
    return quantity;
  };
  return {along(
              "P_star", [](const predict::PredictedRow& row) { return row.state.P; },
              [](const predict::RowSlope& slope) { return slope.state.P; }),
          along(
              "s_par", [](const predict::PredictedRow& row) { return row.s_par; },
              [](const predict::RowSlope& slope) { return slope.s_par; }),
          along(
              "F_par", [](const predict::PredictedRow& row) { return row.F_par; },
              [](const predict::RowSlope& slope) { return slope.F_par; })};
}

}  // namespace grainlaw::chain
