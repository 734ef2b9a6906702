#include "fit/stages/shear_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/data/shear_rows.hpp"
#include "model/reduced_law.hpp"

namespace grainlaw::fit {
namespace {

using Jet2 = ceres::Jet<double, 2>;

constexpr double kShownSaturation = 0.5;  // rate times strain; below, limit and rate are one number, the slope
constexpr double kLargestLimit = 3;       // s_max and F_max: far beyond any frictionless packing
constexpr double kLargestRate = 2000;     // beta: a strain of 5e-4, less than a row

/// Mean of the last tenth of the rows, and 1/beta as the area between the limit and the curve.
void guess(const std::vector<double>& e, const std::vector<double>& value, double start, double& limit, double& rate) {
  const std::size_t n = value.size(), tail = std::max<std::size_t>(1, n / 10);
  limit = 0;
  for (std::size_t i = n - tail; i < n; ++i) limit += value[i] / static_cast<double>(tail);
  double area = 0;
  for (std::size_t i = 1; i < n; ++i) area += (e[i] - e[i - 1]) * (limit - (value[i] + value[i - 1]) / 2);
  const double ratio = area / (limit - start);
  rate = std::isfinite(ratio) && ratio > 0 ? std::clamp(1 / ratio, 1.0, 500.0) : 20;
}

struct Curve {
  Estimate limit, rate;
};

Curve fit_curve(const SaturationProblem& problem, double start, double scale, const CalibrationOptions& options,
                const RunControl& control, Stage& stage) {
  Curve curve;
  const std::string& quantity = problem.blocks.front().channels.front().quantity;
  const StageFit fit = fit_stage("shear " + problem.blocks.front().test, "", problem, "the rows do not determine it",
                                 options.threads, control);
  curve.limit = fit.stage.estimates[0].estimate;
  curve.rate = fit.stage.estimates[1].estimate;
  for (Estimate* e : {&curve.limit, &curve.rate}) {
    e->standard_error = kUndefined;
    if (e->status == Status::fitted) e->note = "one run; the scatter over runs gives the error";
  }
  const auto withdraw = [](Estimate& estimate, const std::string& note) {
    estimate.status = Status::not_identified;
    estimate.note = note;
  };
  if (const double change = std::abs(curve.limit.value - start);
      change <= 0.1 * scale || (!fit.stage.tests.empty() && change < fit.stage.tests.front().rms)) {
    withdraw(curve.rate, fmt::format("{} changes by {:.2g} only, which is its scatter", quantity, change));
  } else if (!shows_saturation(problem.eps_dev, problem.value, problem.weight, start, curve.rate.value,
                               2 * fit.stage.final_cost)) {
    const std::string note = fmt::format("no saturation up to eps_dev = {:.3g}; shear to eps_dev >= {:g}",
                                         problem.eps_dev.back(), options.steady_from);
    withdraw(curve.limit, note);
    withdraw(curve.rate, note);
  }
  if (curve.rate.status == Status::at_bound && curve.rate.value == kLargestRate)
    withdraw(curve.rate, fmt::format("{} has its limit from the first row on; write rows closer together", quantity));
  if (!fit.stage.converged) {
    withdraw(curve.limit, "no convergence: " + fit.stage.termination);
    withdraw(curve.rate, "no convergence: " + fit.stage.termination);
  }
  stage.residuals += fit.stage.residuals;
  stage.free_parameters += fit.stage.free_parameters;
  stage.iterations += fit.stage.iterations;
  stage.initial_cost += fit.stage.initial_cost;
  stage.final_cost += fit.stage.final_cost;
  stage.converged = stage.converged && fit.stage.converged;
  if (!fit.stage.converged)
    stage.termination += fmt::format("; {} {}: {}", problem.blocks.front().test, quantity, fit.stage.termination);
  stage.seconds += fit.stage.seconds;
  stage.tests.insert(stage.tests.end(), fit.stage.tests.begin(), fit.stage.tests.end());
  return curve;
}

}  // namespace

bool shows_saturation(const std::vector<double>& eps_dev, const std::vector<double>& value,
                      const std::vector<double>& weight, double start, double rate, double squared_misfit) {
  double ee = 0, ev = 0, vv = 0;
  for (std::size_t i = 0; i < eps_dev.size(); ++i) {
    const double w2 = weight[i] * weight[i], v = value[i] - start;
    ee += w2 * eps_dev[i] * eps_dev[i];
    ev += w2 * eps_dev[i] * v;
    vv += w2 * v * v;
  }
  if (eps_dev.empty() || ee == 0 || rate * eps_dev.back() < kShownSaturation) return false;
  const double of_line = vv - ev * ev / ee;
  return of_line >= 2 * squared_misfit;
}

SaturationProblem saturation_problem(const std::string& test, const std::string& quantity,
                                     const std::vector<double>& eps_dev, const std::vector<double>& value, double start,
                                     const CalibrationOptions& options) {
  double limit = 0, rate = 0;
  guess(eps_dev, value, start, limit, rate);
  SaturationProblem problem;
  problem.loss = options.loss;
  problem.parameters = {{"limit", limit, 0, kLargestLimit, 0.1}, {"rate", rate, 1e-3, kLargestRate, 20}};
  const RowWeights rows = shear_window(eps_dev, options);
  const int n = static_cast<int>(rows.row.size());
  ResidualBlock block;
  block.test = test;
  block.weight = Eigen::Map<const Eigen::VectorXd>(rows.weight.data(), n);
  Channel channel{quantity, 0, n, static_cast<int>(eps_dev.size()) - n, 0};
  problem.weight = rows.weight;
  for (std::size_t i : rows.row) {
    problem.eps_dev.push_back(eps_dev[i]);
    problem.value.push_back(value[i]);
    channel.max_abs_data = std::max(channel.max_abs_data, std::abs(value[i]));
  }
  block.channels.push_back(channel);
  block.evaluate = differentiated<Jet2>(
      [e = problem.eps_dev, datum = problem.value, start](const auto* x, auto* misfit) {
        using T = std::decay_t<decltype(*x)>;
        for (std::size_t i = 0; i < e.size(); ++i) misfit[i] = saturating(x[0], T(start), x[1], e[i]) - datum[i];
        return true;
      },
      2, n);
  problem.blocks.push_back(std::move(block));
  return problem;
}

ShearFit fit_shear(const TestRecord& test, double nu_c, const CalibrationOptions& options, const RunControl& control,
                   Stage& stage) {
  const LawDirection direction = law_direction(test.path.segments.front().direction);
  const Observation& first = test.rows.front();
  ShearFit fit;
  fit.test = test.name;
  fit.mode = test.path.segments.front().mode;
  fit.seed = test.packing.seed;
  fit.nu = first.nu;
  fit.lode = direction.lode;
  std::vector<double> eps_dev, s, F;
  double C_star = 0, phi_r = 0, P = 0, s_sum = 0, F_sum = 0;
  int steady = 0;
  const SteadyOnset onset = steady_onset(test);
  fit.steady_from = onset.from(options.steady_from);
  fit.steady_since_s = onset.s;
  fit.steady_since_F = onset.F;
  fit.steady_since_P = onset.P;
  for (const Observation& row : test.rows) {
    if (!is_jammed(row)) continue;  // s is undefined without pressure; counted as excluded below
    const LawState<double> state = measured_state(test, row);
    eps_dev.push_back(deviatoric_norm(row.strain.tensor - first.strain.tensor));
    s.push_back(state.sigma.dot(direction.N) / state.P);
    F.push_back(state.F.dot(direction.N));
    if (eps_dev.back() >= fit.steady_from - 1e-9) {
      ++steady;
      C_star += row.C_star;
      phi_r += row.rattler_fraction;
      P += row.P_star;
      s_sum += s.back();
      F_sum += F.back();
    }
  }
  const auto mean = [&](double sum) { return steady > 0 ? sum / steady : kUndefined; };
  fit.C_star = mean(C_star);
  fit.rattler_fraction = mean(phi_r);
  fit.P_star = mean(P);
  fit.s_steady = mean(s_sum);
  fit.F_steady = mean(F_sum);
  const auto unfit = [&](const std::string& note) {
    for (Estimate* e : {&fit.s_max, &fit.beta_s, &fit.F_max, &fit.beta_F})
      *e = {0, kUndefined, Status::not_identified, note};
    return fit;
  };
  const int rows = static_cast<int>(test.rows.size());
  if (fit.nu <= nu_c || !is_jammed(first)) {
    stage.tests.push_back({test.name, "s_par", false, 0, rows, 0, 0, 0, 0});
    stage.tests.push_back({test.name, "F_par", false, 0, rows, 0, 0, 0, 0});
    return unfit(
        fmt::format("not jammed at the start (nu = {:.5g}, nu_c = {:.5g}, P* = {:.3g})", fit.nu, nu_c, first.P_star));
  }
  if (shear_window(eps_dev, options).row.size() < 3) return unfit("fewer than three jammed rows in the windows");
  fit.eps_dev_max = eps_dev.back();
  fit.s_0 = s.front();
  fit.F_0 = F.front();
  const auto run = [&](const std::string& quantity, const std::vector<double>& value, double scale, Estimate& limit,
                       Estimate& rate) {
    SaturationProblem problem = saturation_problem(test.name, quantity, eps_dev, value, value.front(), options);
    problem.blocks.front().channels.front().excluded += rows - static_cast<int>(eps_dev.size());
    const Curve curve = fit_curve(problem, value.front(), scale, options, control, stage);
    limit = curve.limit;
    rate = curve.rate;
  };
  run("s_par", s, options.stress_scale, fit.s_max, fit.beta_s);
  if (tells_fabric(test))
    run("F_par", F, options.fabric_scale, fit.F_max, fit.beta_F);
  else
    for (Estimate* e : {&fit.F_max, &fit.beta_F}) *e = {0, kUndefined, Status::not_identified, kAddFabric};
  return fit;
}

std::vector<ShearFit> fit_shear_tests(const DataSet& data, double nu_c, const CalibrationOptions& options,
                                      const RunControl& control, Stage& stage) {
  stage.name = "shear";
  stage.window = fmt::format(
      "each test of shear at constant volume for itself: 0 < eps_dev <= {:g} and eps_dev >= {:g}, the second window "
      "with {:g} times the weight of the first; start measured in the first row",
      options.rate_window, options.steady_from, options.steady_weight);
  stage.converged = true;
  stage.termination = "one fit per test and quantity";
  std::vector<ShearFit> fits;
  for (const TestRecord* test : data.pure_shear) fits.push_back(fit_shear(*test, nu_c, options, control, stage));
  return fits;
}

}  // namespace grainlaw::fit
