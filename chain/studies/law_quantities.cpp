#include "chain/studies/law_quantities.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "dem/runs/spec_file.hpp"
#include "fit/staged_laws.hpp"
#include "predict/compare.hpp"
#include "predict/segment_sensitivity.hpp"

namespace grainlaw::chain {
namespace {

constexpr int kStudyPoints = 100;
constexpr double kFewestShowing = 2;

using Values = LawParameters<double>;

/// A number that the law makes of its parameters, and the groups of parameters that it reads.
struct LawQuantity {
  std::string name;
  std::vector<const char*> groups;
  std::function<double(const Values&)> of;
};

std::vector<LawQuantity> quantities_at(const std::vector<double>& densities) {
  std::vector<LawQuantity> all;
  for (const double nu : densities) {
    const std::string at = "@" + dem::density_text(nu);
    all.push_back({"P_star" + at, {"coordination", "rattlers", "pressure"}, [nu](const Values& law) {
                     return law.isotropic.P_star(nu);
                   }});
    all.push_back(
        {"C_star" + at, {"coordination"}, [nu](const Values& law) { return law.isotropic.coordination.C_star(nu); }});
    const auto add_shear = [&](const char* name, const char* group, ExponentialLaw<double> Values::*Q) {
      all.push_back({name + at, {group}, [nu, Q](const Values& law) { return (law.*Q).value(nu, law.shear_nu_c); }});
    };
    add_shear("s_max", "stress_ratio_max", &Values::stress_ratio_max);
    add_shear("beta_s", "stress_rate", &Values::stress_rate);
    add_shear("F_max", "fabric_max", &Values::fabric_max);
    add_shear("beta_F", "fabric_rate", &Values::fabric_rate);
  }
  all.push_back({"nu_c", {"pressure"}, [](const Values& law) { return law.isotropic.pressure.nu_c; }});
  return all;
}

/// Rows of the parameters that have an error, padded to all packings.
Eigen::MatrixXd influence_of(const fit::Calibration& calibration, const std::vector<std::size_t>& parameters,
                             std::size_t packings) {
  Eigen::MatrixXd influence = calibration.errors.influence;
  fit::widen(influence, static_cast<Eigen::Index>(packings));
  return influence(parameters, Eigen::all);
}

struct OnePacking {
  std::vector<std::string> names;
  std::vector<double> values;  ///< NaN where the packing does not show it [-]
};

double value_or_nan(const Estimate& estimate) {
  return estimate.status == Status::not_identified ? kMissing : estimate.value;
}

OnePacking quantities_of(const Dataset& dataset, std::uint64_t seed) {
  std::vector<TestRecord> tests;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration && test.record.packing.seed == seed) tests.push_back(test.record);
  }
  const fit::DataSet data = fit::check_and_sort(tests);
  const fit::CalibrationOptions options;
  fit::Calibration c = fit::nothing_known();
  fit::fit_unloading_laws("ISO unloading", fit::isotropic_series(data, options), c, options, {});
  fit::fit_shear_laws(data, c, options, {});

  OnePacking result;
  const auto add = [&](const std::string& name, double value) {
    result.names.push_back(name);
    result.values.push_back(value);
  };
  const bool has_pressure = has_values(c.law, "pressure"), has_coordination = has_values(c.law, "coordination");
  for (const fit::ShearFit& shear : c.shear) {
    const std::string at = "@" + dem::density_text(std::round(shear.nu * 1e6) / 1e6);
    add("P_star" + at, has_pressure && has_coordination ? c.law.parameters.isotropic.P_star(shear.nu) : kMissing);
    add("C_star" + at, has_coordination ? c.law.parameters.isotropic.coordination.C_star(shear.nu) : kMissing);
    add("s_max" + at, value_or_nan(shear.s_max));
    add("beta_s" + at, value_or_nan(shear.beta_s));
    add("F_max" + at, value_or_nan(shear.F_max));
    add("beta_F" + at, value_or_nan(shear.beta_F));
  }
  add("nu_c", has_pressure ? c.law.parameters.isotropic.pressure.nu_c : kMissing);
  return result;
}

/// Mean of the packings that show it; not shown by fewer than kFewestShowing.
StudyQuantity mean_of(const std::string& name, const Eigen::RowVectorXd& x) {
  const Eigen::Array<bool, 1, Eigen::Dynamic> shown = x.array().isFinite();
  const auto n = static_cast<double>(shown.count());
  StudyQuantity quantity{name, Eigen::VectorXd::Constant(1, kMissing), Eigen::MatrixXd::Zero(1, x.size()),
                         name != "nu_c"};
  if (n < kFewestShowing) return quantity;
  const Eigen::RowVectorXd counted = shown.select(x.array(), 0.0).matrix();
  quantity.values(0) = counted.sum() / n;
  quantity.influence = shown.select((x.array() - quantity.values(0)) / std::sqrt(n * (n - 1)), 0.0).matrix();
  return quantity;
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
  const auto points = predict::uniform_points(segments, kStudyPoints);
  std::vector<StudyQuantity> quantities;
  for (const predict::ComparedQuantity& of : predict::kComparedQuantities) {
    const auto rows = static_cast<Eigen::Index>(points.size());
    quantities.push_back({of.name, Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, influence.cols()), true});
  }
  Eigen::Index row = 0;
  const auto add_influence = [&](const predict::PredictedRow&, const std::vector<predict::RowSlope>& slopes) {
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      Eigen::RowVectorXd of_row(influence.rows());
      for (std::size_t k = 0; k < slopes.size(); ++k)
        of_row(static_cast<Eigen::Index>(k)) = predict::kComparedQuantities[q].slope(slopes[k]);
      quantities[q].influence.row(row) = of_row * influence;
    }
    ++row;
  };
  const predict::Prediction prediction =
      predict::predict(rung, calibration.law.parameters, calibration.law.coupling, segments,
                       predict::state_from_law(calibration.law.parameters, path.nu), points, {}, {}, control,
                       {parameters, true, add_influence});
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    for (std::size_t i = 0; i < prediction.rows.size(); ++i)
      quantities[q].values(static_cast<Eigen::Index>(i)) =
          predict::kComparedQuantities[q].predicted(prediction.rows[i]);
  }
  return quantities;
}

std::vector<StudyQuantity> packing_quantities(const Dataset& dataset, const std::vector<std::uint64_t>& seeds) {
  std::vector<OnePacking> packings;
  for (const std::uint64_t seed : seeds) packings.push_back(quantities_of(dataset, seed));
  const auto n = static_cast<Eigen::Index>(packings.size());
  std::vector<StudyQuantity> quantities;
  for (std::size_t q = 0; q < packings.front().names.size(); ++q) {
    Eigen::RowVectorXd x(n);
    for (Eigen::Index c = 0; c < n; ++c) x(c) = packings[static_cast<std::size_t>(c)].values.at(q);
    quantities.push_back(mean_of(packings.front().names[q], x));
  }
  return quantities;
}

}  // namespace grainlaw::chain
