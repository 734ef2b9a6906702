#include "fit/stages/density_law_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace grainlaw::fit {
namespace {

using Jet3 = ceres::Jet<double, 3>;

ExponentialLaw<double> best_start(const std::vector<Eigen::Vector2d>& values, const Eigen::VectorXd& weight,
                                  double nu_c, const std::array<FreeParameter, 3>& bounds) {
  const auto n = static_cast<Eigen::Index>(values.size());
  ExponentialLaw<double> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double alpha : {2.5, 5.0, 10.0, 20.0, 40.0}) {
    Eigen::MatrixXd A(n, 2);
    Eigen::VectorXd q(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector2d& v = values[static_cast<std::size_t>(i)];
      A.row(i) << weight(i), weight(i) * std::exp(-alpha * (v(0) / nu_c - 1));
      q(i) = weight(i) * v(1);
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

}  // namespace

const std::array<ShearQuantity, 4> kShearQuantities{{
    {"stress_ratio_max", &ShearFit::s_max, &LawParameters<double>::stress_ratio_max},
    {"stress_rate", &ShearFit::beta_s, &LawParameters<double>::stress_rate},
    {"fabric_max", &ShearFit::F_max, &LawParameters<double>::fabric_max},
    {"fabric_rate", &ShearFit::beta_F, &LawParameters<double>::fabric_rate},
}};

DensityLawProblem density_law_problem(const std::string& name, const std::vector<std::string>& tests,
                                      const std::vector<int>& cluster, const std::vector<Eigen::Vector2d>& values,
                                      double nu_c) {
  double mean = 0;
  for (const Eigen::Vector2d& v : values) mean += std::abs(v(1)) / static_cast<double>(values.size());
  Eigen::VectorXd weight(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    weight(static_cast<Eigen::Index>(i)) = 1 / std::max({std::abs(values[i](1)), 0.2 * mean, 1e-12});
  }
  std::array<FreeParameter, 3> p{free_parameter(name + ".Q_limit", 0), free_parameter(name + ".Q_c", 0),
                                 free_parameter(name + ".alpha", 0)};
  const ExponentialLaw<double> start = best_start(values, weight, nu_c, p);
  DensityLawProblem problem;
  problem.parameters = {free_parameter(name + ".Q_limit", start.Q_limit), free_parameter(name + ".Q_c", start.Q_c),
                        free_parameter(name + ".alpha", start.alpha)};
  for (std::size_t i = 0; i < values.size(); ++i) {
    ResidualBlock block;
    block.test = tests[i];
    block.cluster = cluster[i];
    block.weight = weight.segment<1>(static_cast<Eigen::Index>(i));
    block.channels.push_back({name, 0, 1, 0, std::abs(values[i](1))});
    block.evaluate = differentiated<Jet3>(
        [nu = values[i](0), Q = values[i](1), nu_c](const auto* x, auto* misfit) {
          using T = std::decay_t<decltype(*x)>;
          misfit[0] = ExponentialLaw<T>{x[0], x[1], x[2]}.value(nu, T(nu_c)) - Q;
          return true;
        },
        3, 1);
    problem.blocks.push_back(std::move(block));
  }
  return problem;
}

void settle_constant_law(StageFit& fit, const std::string& law) {
  std::vector<NamedEstimate>& all = fit.stage.estimates;
  const auto at = std::find_if(all.begin(), all.end(), [&](const NamedEstimate& e) { return e.name == law + ".Q_c"; });
  if (at == all.end() || at->estimate.status != Status::at_bound || at->estimate.value != 0) return;
  Estimate& alpha = (at + 1)->estimate;
  alpha.status = Status::fixed;
  alpha.note = "without effect while Q_c is 0";
}

StageFit fit_density_law(const ShearQuantity& quantity, const std::vector<ShearFit>& shear,
                         const std::vector<int>& cluster, LawParameters<double>& law, const CalibrationOptions& options,
                         const RunControl& control) {
  const std::string name = quantity.name;
  std::vector<std::string> tests;
  std::vector<int> cluster_of_test;
  std::vector<Eigen::Vector2d> values;
  std::vector<double> nu;
  for (std::size_t i = 0; i < shear.size(); ++i) {
    const Estimate& estimate = shear[i].*quantity.estimate;
    if (estimate.status != Status::fitted && estimate.status != Status::at_bound) continue;
    tests.push_back(shear[i].test);
    cluster_of_test.push_back(cluster[i]);
    values.emplace_back(shear[i].nu, estimate.value);
    nu.push_back(shear[i].nu);
  }
  const int found = distinct_densities(nu);
  const std::string remedy = fmt::format(
      "{} of at least {} densities with shear at constant volume that shows {}; test more densities, each to eps_dev "
      ">= {:g}",
      found, kDensitiesNeeded, name, options.steady_from);
  if (values.empty()) return skipped_stage(name, {name + ".Q_limit", name + ".Q_c", name + ".alpha"}, remedy);

  const DensityLawProblem problem = density_law_problem(name, tests, cluster_of_test, values, law.shear_nu_c);
  StageFit fit = fit_stage(name, fmt::format("values of the stage shear, relative, nu_c = {:g} fixed", law.shear_nu_c),
                           problem.parameters, problem.blocks, remedy, options.threads, control, {options.loss});
  law.*quantity.law = {fit.solution.x(0), fit.solution.x(1), fit.solution.x(2)};
  settle_constant_law(fit, name);
  if (found < kDensitiesNeeded) {
    for (const FreeParameter& p : problem.parameters) fit.mark_not_identified(p.name, remedy);
  }
  return fit;
}

}  // namespace grainlaw::fit
