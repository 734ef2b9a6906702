#include "chain/studies/packing_quantities.hpp"

#include <cmath>

#include "dem/runs/spec_file.hpp"
#include "fit/staged_laws.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kFewestShowing = 2;

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
