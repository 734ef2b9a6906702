#include "fit/stages/density_law_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::fit {
namespace {

using Jet3 = ceres::Jet<double, 3>;

/// The value that one test gave.
struct DensityValue {
  std::string test;
  int cluster;
  double nu, Q;
  double weight = 1;
};

ExponentialLaw<double> best_start(const std::vector<DensityValue>& values, const std::string& law, double nu_c) {
  const auto n = static_cast<Eigen::Index>(values.size());
  const std::array<FreeParameter, 2> bounds{free_parameter(law + ".Q_limit", 0), free_parameter(law + ".Q_c", 0)};
  ExponentialLaw<double> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double alpha : {2.5, 5.0, 10.0, 20.0, 40.0}) {
    Eigen::MatrixXd A(n, 2);
    Eigen::VectorXd q(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const DensityValue& v = values[static_cast<std::size_t>(i)];
      A.row(i) << v.weight, v.weight * std::exp(-alpha * (v.nu / nu_c - 1));
      q(i) = v.weight * v.Q;
    }
    Eigen::Vector2d x = A.completeOrthogonalDecomposition().solve(q);
    for (int k = 0; k < 2; ++k)
      x(k) = std::clamp(x(k), bounds[static_cast<std::size_t>(k)].lower, bounds[static_cast<std::size_t>(k)].upper);
    const double cost = (A * x - q).squaredNorm();
    if (cost < best_cost) {
      best_cost = cost;
      best = {x(0), x(1), alpha};
    }
  }
  return best;
}

/// Relative to what a law through all of them gives at their density: relative to themselves, small ones would count for more
/// because they came out small, and the law too low by twice their relative variance.
std::vector<DensityValue> values_of(const ShearQuantity& quantity, const std::vector<ShearFit>& shear,
                                    const std::vector<int>& cluster, double nu_c) {
  std::vector<DensityValue> values;
  for (std::size_t i = 0; i < shear.size(); ++i) {
    const Estimate& estimate = shear[i].*quantity.estimate;
    if (estimate.status == Status::fitted || estimate.status == Status::at_bound)
      values.push_back({shear[i].test, cluster[i], shear[i].nu, estimate.value});
  }
  if (values.empty()) return values;
  double mean = 0;
  for (const DensityValue& v : values) mean += std::abs(v.Q) / static_cast<double>(values.size());
  const ExponentialLaw<double> through = best_start(values, quantity.name, nu_c);
  for (DensityValue& v : values) v.weight = 1 / std::max({std::abs(through.value(v.nu, nu_c)), 0.2 * mean, 1e-12});
  return values;
}

std::vector<ResidualBlock> value_blocks(const std::vector<DensityValue>& values, const std::string& law, double nu_c) {
  std::vector<ResidualBlock> blocks;
  for (const DensityValue& v : values) {
    ResidualBlock block;
    block.test = v.test;
    block.cluster = v.cluster;
    block.weight = Eigen::VectorXd::Constant(1, v.weight);
    block.channels.push_back({law, 0, 1, 0, std::abs(v.Q)});
    block.evaluate = differentiated<Jet3>(
        [nu = v.nu, Q = v.Q, nu_c](const auto* x, auto* misfit) {
          using T = std::decay_t<decltype(*x)>;
          misfit[0] = ExponentialLaw<T>{x[0], x[1], x[2]}.value(nu, T(nu_c)) - Q;
          return true;
        },
        3, 1);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace

const std::array<ShearQuantity, 4> kShearQuantities{{
    {"stress_ratio_max", &ShearFit::s_max, &LawParameters<double>::stress_ratio_max},
    {"stress_rate", &ShearFit::beta_s, &LawParameters<double>::stress_rate},
    {"fabric_max", &ShearFit::F_max, &LawParameters<double>::fabric_max},
    {"fabric_rate", &ShearFit::beta_F, &LawParameters<double>::fabric_rate},
}};

void settle_constant_law(StageFit& fit, const std::string& law) {
  const Eigen::Index at = fit.find(law + ".Q_c");
  if (at < 0) return;
  const auto Q_c = fit.stage.estimates.begin() + at;
  if (Q_c->estimate.status != Status::at_bound || Q_c->estimate.value != 0) return;
  Estimate& alpha = (Q_c + 1)->estimate;
  alpha.status = Status::fixed;
  alpha.note = "without effect while Q_c is 0";
}

StageDefinition density_law_stage(const ShearQuantity& quantity, const std::vector<ShearFit>& shear,
                                  const std::vector<int>& cluster, double nu_c, const CalibrationOptions& options) {
  const std::string name = quantity.name;
  const std::vector<DensityValue> values = values_of(quantity, shear, cluster, nu_c);
  std::vector<double> nu;
  for (const DensityValue& v : values) nu.push_back(v.nu);
  const int found = distinct_densities(nu);
  const bool without_fabric = !shear.empty() && std::ranges::all_of(shear, [&](const ShearFit& fit) {
    return (fit.*quantity.estimate).note == kAddFabric;
  });
  if (without_fabric) return left_out(name, parameters_of(name), kAddFabric);
  const std::string remedy = fmt::format(
      "{} of at least {} densities with shear at constant volume that shows {}; test more densities, each to eps_dev "
      ">= {:g}",
      found, kDensitiesNeeded, name, options.steady_from);
  if (values.empty()) return left_out(name, parameters_of(name), remedy);

  StageDefinition stage;
  stage.name = name;
  stage.window = fmt::format("values of the stage shear, relative to a curve through them, nu_c = {:g} fixed", nu_c);
  stage.free = parameters_of(name);
  stage.remedy = remedy;
  stage.start = [=](LawParameters<double>& law) { law.*quantity.law = best_start(values, name, nu_c); };
  stage.blocks = [=](const LawParameters<double>&) { return value_blocks(values, name, nu_c); };
  stage.judge = [=](StageFit& fit, const LawParameters<double>&) {
    settle_constant_law(fit, name);
    if (found >= kDensitiesNeeded) return;
    for (const std::string& parameter : parameters_of(name)) fit.mark_not_identified(parameter, remedy);
  };
  return stage;
}

}  // namespace grainlaw::fit
