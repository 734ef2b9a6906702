#include "fit/statistics/stage_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/statistics/covariance.hpp"
#include "fit/statistics/huber_loss.hpp"
#include "fit/statistics/search.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

constexpr int kSlopeRounds = 3;  // of slopes by errors and errors by slopes; the third moves errors by some 2 %

std::vector<TestResidual> misfit_per_test(const std::vector<ResidualBlock>& blocks, const Solution& solution) {
  std::vector<TestResidual> tests;
  Eigen::Index first = 0;
  for (const ResidualBlock& block : blocks) {
    for (const Channel& channel : block.channels) {
      const Eigen::VectorXd d = solution.misfit.segment(first + channel.first, channel.rows);
      const Eigen::VectorXd w = solution.weight.segment(first + channel.first, channel.rows);
      auto at = std::ranges::find_if(
          tests, [&](const TestResidual& t) { return t.test == block.test && t.quantity == channel.quantity; });
      if (at == tests.end()) {
        at = tests.insert(tests.end(), TestResidual{});
        at->test = block.test;
        at->quantity = channel.quantity;
        at->in_cost = false;
      }
      at->in_cost = at->in_cost || (w.size() > 0 && w.maxCoeff() > 0);
      at->rows += channel.rows;
      at->rows_lightened += static_cast<int>(
          (w.array() < std::sqrt(0.5) * block.weight.segment(channel.first, channel.rows).array()).count());
      at->rows_excluded += channel.excluded;
      at->max_abs_data = std::max(at->max_abs_data, channel.max_abs_data);
      if (channel.rows > 0) {  // sums for now, divided below
        at->rms += d.squaredNorm();
        at->bias += d.sum();
      }
    }
    first += block.rows();
  }
  for (TestResidual& t : tests) {
    if (t.rows == 0) continue;
    t.rms = std::sqrt(t.rms / t.rows);
    t.bias /= t.rows;
  }
  return tests;
}

ClusterCovariance covariance_of(const Solution& solution) {
  std::vector<Eigen::Index> rows;
  std::vector<int> cluster;
  for (Eigen::Index i = 0; i < solution.weight.size(); ++i) {
    if (solution.weight(i) > 0) {
      rows.push_back(i);
      cluster.push_back(solution.cluster[static_cast<std::size_t>(i)]);
    }
  }
  const Eigen::VectorXd w = solution.weight(rows);
  std::vector<bool> free(solution.at_bound);
  free.flip();
  return cluster_covariance(w.asDiagonal() * solution.jacobian(rows, Eigen::all), w.cwiseProduct(solution.misfit(rows)),
                            cluster, free, solution.curvature);
}

}  // namespace

Eigen::Index StageFit::find(const std::string& name) const {
  const auto at = std::ranges::find(stage.estimates, name, &NamedEstimate::name);
  return at == stage.estimates.end() ? -1 : at - stage.estimates.begin();
}

void StageFit::mark_not_identified(const std::string& name, const std::string& note) {
  const Eigen::Index k = find(name);
  if (k < 0) throw Error("stage " + stage.name + " has no parameter " + name);
  Estimate& estimate = stage.estimates[static_cast<std::size_t>(k)].estimate;
  estimate.status = Status::not_identified;
  estimate.standard_error = kUndefined;
  estimate.note = note;
  estimate.degrees_of_freedom = kUndefined;
  influence.row(k).setZero();
}

StageFit fit_stage(const std::string& name, const std::string& window, const Problem& problem,
                   const std::string& remedy, int threads, const RunControl& control, int starts) {
  StageFit fit;
  const std::vector<FreeParameter>& parameters = problem.parameters;
  fit.solution = minimise(problem, starts, threads, name, control, fit.stage.starts);
  if (fit.solution.defined) fit.solution.curvature = curvature(problem, fit.solution, threads);
  const Solution& solution = fit.solution;
  Stage& stage = fit.stage;
  stage.name = name;
  stage.window = window;
  stage.residuals = static_cast<int>((solution.weight.array() > 0).count());
  stage.free_parameters = static_cast<int>(parameters.size());
  stage.iterations = solution.iterations;
  stage.initial_cost = solution.initial_cost;
  stage.final_cost = solution.final_cost;
  stage.termination = solution.termination;
  stage.converged = solution.converged;
  stage.seconds = solution.seconds;
  const auto n = static_cast<Eigen::Index>(parameters.size());
  fit.influence = Eigen::MatrixXd::Zero(n, 0);
  for (const FreeParameter& p : parameters) stage.estimates.push_back({p.name, {}});
  if (!solution.defined) {
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      stage.estimates[k].estimate.value = solution.x(static_cast<Eigen::Index>(k));
      fit.mark_not_identified(parameters[k].name, "the stage has no finite solution: " + solution.termination);
    }
    return fit;
  }
  stage.tests = misfit_per_test(problem.blocks, solution);

  ClusterCovariance errors = covariance_of(solution);
  for (int round = 0; problem.loss == Loss::huber && round < kSlopeRounds; ++round) {
    fit.solution.pull_slope = pull_slopes(solution, errors.influence);
    fit.solution.curvature = curvature(problem, solution, threads);
    errors = covariance_of(solution);
    errors.influence += influence_of_reach(problem.blocks, solution, errors.influence);
  }
  fit.influence = errors.influence;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    Estimate& estimate = stage.estimates[k].estimate;
    estimate.value = solution.x(i);
    estimate.standard_error = kUndefined;
    if (solution.at_bound[k]) {
      estimate.status = Status::at_bound;
      estimate.note = fmt::format("ended on its bound {:g}", estimate.value);
    } else if (!errors.identified[k]) {
      fit.mark_not_identified(parameters[k].name, remedy);
    } else {
      estimate.status = Status::fitted;
      if (errors.has_error[k]) {
        estimate.standard_error = errors.influence.row(i).norm();
        estimate.degrees_of_freedom = errors.degrees_of_freedom(i);
      } else {
        estimate.note = "rests on a single packing, hence no error; add seeds";
      }
    }
  }
  return fit;
}

}  // namespace grainlaw::fit
