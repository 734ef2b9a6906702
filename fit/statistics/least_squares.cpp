#include "fit/statistics/least_squares.hpp"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kGradientCosine = 1e-5;  // |cos| between the residual and every column of J at a true minimum
constexpr double kExactFit = 1e-9;        // misfit over data below which the cosine is that of rounding errors
constexpr double kOnBound = 1e-7;         // distance in units of the parameter's scale
constexpr double kCurvatureStep = 1e-6;   // of a parameter's scale
constexpr double kSettled = 1e-9;         // relative decrease of the cost over a whole round that is none

/// All blocks as one cost function of x/scale.
class Blocks : public ceres::CostFunction {
 public:
  /// Weighted misfits are divided by `unit`, so that the solver's tolerances are relative.
  Blocks(const std::vector<ResidualBlock>& blocks, Eigen::VectorXd scale, double unit, int threads)
      : blocks_(blocks), scale_(std::move(scale)), unit_(unit), threads_(threads), rows_(row_count(blocks)) {
    for (int row = 0; const ResidualBlock& block : blocks_) {
      first_row_.push_back(row);
      row += block.rows();
    }
    set_num_residuals(rows_);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(scale_.size()));
  }

  bool Evaluate(double const* const* z, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(z[0], scale_.size()).cwiseProduct(scale_);
    double* jacobian = jacobians == nullptr ? nullptr : jacobians[0];
    if (!misfit(x, residuals, jacobian)) return false;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Eigen::VectorXd& w = blocks_[b].weight;
      Eigen::Map<Eigen::VectorXd>(residuals + first_row_[b], w.size()).array() *= w.array() / unit_;
    }
    if (jacobian != nullptr) {
      Eigen::Map<RowMajor> J(jacobian, rows_, scale_.size());
      J = J * scale_.asDiagonal();
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const Eigen::VectorXd& w = blocks_[b].weight;
        J.middleRows(first_row_[b], w.size()).array().colwise() *= w.array() / unit_;
      }
    }
    return true;
  }

  /// Unweighted model - data and d/dx.
  bool misfit(const Eigen::VectorXd& x, double* values, double* jacobian) const {
    return fit::evaluate(blocks_, x, threads_, values, jacobian);
  }

  /// The first block that has no finite value at `x`, for messages.
  std::string offender(const Eigen::VectorXd& x) const {
    for (const ResidualBlock& block : blocks_) {
      std::vector<double> values(static_cast<std::size_t>(block.rows()), std::nan(""));
      const bool defined = block.evaluate(x.data(), values.data(), nullptr);
      const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
      if (!defined || bad != values.end()) {
        return fmt::format("test {}, row {} of the fit", block.test, bad - values.begin() + 1);
      }
    }
    return "none";
  }

 private:
  const std::vector<ResidualBlock>& blocks_;
  Eigen::VectorXd scale_;
  double unit_;
  int threads_;
  int rows_;
  std::vector<int> first_row_;
};

class StopOnRequest : public ceres::IterationCallback {
 public:
  StopOnRequest(std::string stage, const RunControl& control) : stage_(std::move(stage)), control_(control) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (control_.report) control_.report({stage_, 0, static_cast<double>(iteration.iteration), "iterations"});
    return control_.stop.stop_requested() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  std::string stage_;
  const RunControl& control_;
};

/// Norm of the weighted data, an upper estimate.
double data_norm(const std::vector<ResidualBlock>& blocks) {
  double square = 0;
  for (const ResidualBlock& block : blocks) {
    for (const Channel& c : block.channels)
      square += (block.weight.segment(c.first, c.rows) * c.max_abs_data).squaredNorm();
  }
  return square > 0 ? std::sqrt(square) : 1;
}

/// Ceres also reports success when its trust region has shrunk to nothing. A minimum is one when the weighted residual
/// is orthogonal to every column of J whose parameter is free to move.
bool is_minimum(const Solution& solution, double unit, const std::vector<int>& held) {
  const Eigen::VectorXd r = solution.weight.cwiseProduct(solution.misfit);
  if (r.norm() <= kExactFit * unit) return true;
  for (Eigen::Index k = 0; k < solution.x.size(); ++k) {
    if (std::find(held.begin(), held.end(), static_cast<int>(k)) != held.end()) continue;
    const Eigen::VectorXd column = solution.weight.cwiseProduct(solution.jacobian.col(k));
    if (std::abs(column.dot(r)) > kGradientCosine * column.norm() * r.norm()) return false;
  }
  return true;
}

/// Parameters on a bound that the cost would push further out.
std::vector<int> held_by_bounds(const Solution& solution, const std::vector<FreeParameter>& parameters) {
  std::vector<int> held;
  const Eigen::VectorXd w2r = solution.weight.cwiseAbs2().cwiseProduct(solution.misfit);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double gradient = solution.jacobian.col(i).dot(w2r);
    if ((solution.x(i) == parameters[k].lower && gradient > 0) ||
        (solution.x(i) == parameters[k].upper && gradient < 0)) {
      held.push_back(static_cast<int>(k));
    }
  }
  return held;
}

std::string listed(const std::vector<FreeParameter>& parameters, const Eigen::VectorXd& x) {
  std::string text;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    text += fmt::format("{}{} = {:.6g}", k == 0 ? "" : ", ", parameters[k].name, x(static_cast<Eigen::Index>(k)));
  }
  return text;
}

ceres::Solver::Options solver_options(ceres::IterationCallback* callback, int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-16;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-12;
  // No line search along projected steps: it shortens a step where the trust region would turn it.
  options.max_num_line_search_step_size_iterations = 0;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.callbacks.push_back(callback);
  return options;
}

/// Values, Jacobian and bounds at the scaled parameters `z`.
void evaluate(const Blocks& cost, const Eigen::VectorXd& z, const std::vector<FreeParameter>& parameters,
              Solution& solution) {
  solution.x.resize(z.size());
  solution.at_bound.clear();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const FreeParameter& p = parameters[k];
    double& x = solution.x(static_cast<Eigen::Index>(k));
    x = z(static_cast<Eigen::Index>(k)) * p.scale;
    if (x - p.lower <= kOnBound * p.scale) x = p.lower;
    if (p.upper - x <= kOnBound * p.scale) x = p.upper;
    solution.at_bound.push_back(x == p.lower || x == p.upper);
  }
  RowMajor jacobian(solution.weight.size(), z.size());
  solution.misfit.resize(solution.weight.size());
  solution.defined = cost.misfit(solution.x, solution.misfit.data(), jacobian.data());
  solution.jacobian = jacobian;
}

/// A few iterations from `z` with the parameters `held` taken out.
ceres::Solver::Summary solve_round(Blocks& cost, const std::vector<FreeParameter>& parameters,
                                   const std::vector<int>& held, double radius, int iterations, StopOnRequest& stop,
                                   Eigen::VectorXd& z) {
  ceres::Problem::Options keep;
  keep.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(keep);
  problem.AddResidualBlock(&cost, nullptr, z.data());
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const FreeParameter& p = parameters[k];
    problem.SetParameterLowerBound(z.data(), static_cast<int>(k), p.lower / p.scale);
    problem.SetParameterUpperBound(z.data(), static_cast<int>(k), p.upper / p.scale);
  }
  if (!held.empty()) problem.SetManifold(z.data(), new ceres::SubsetManifold(static_cast<int>(z.size()), held));
  ceres::Solver::Options options = solver_options(&stop, iterations);
  options.initial_trust_region_radius = radius;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

}  // namespace

Solution solve(const Problem& problem, int threads, const std::string& stage, const RunControl& control,
               const SolverEffort& effort) {
  const std::vector<FreeParameter>& parameters = problem.parameters;
  const std::vector<ResidualBlock>& blocks = problem.blocks;
  if (control.stop.stop_requested()) throw Interrupted("fit: stopped on request");
  const auto begin = std::chrono::steady_clock::now();
  const auto n = static_cast<Eigen::Index>(parameters.size());
  Solution solution;
  Eigen::VectorXd scale(n), z(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const FreeParameter& p = parameters[static_cast<std::size_t>(k)];
    scale(k) = p.scale;
    z(k) = std::clamp(p.start, p.lower, p.upper) / p.scale;
  }
  for (const ResidualBlock& block : blocks) {
    solution.cluster.insert(solution.cluster.end(), static_cast<std::size_t>(block.rows()), block.cluster);
  }
  solution.weight.resize(row_count(blocks));
  for (Eigen::Index row = 0; const ResidualBlock& block : blocks) {
    solution.weight.segment(row, block.rows()) = block.weight;
    row += block.rows();
  }
  solution.reach = Eigen::VectorXd::Constant(solution.weight.size(), std::numeric_limits<double>::infinity());
  solution.pull_slope = Eigen::VectorXd::Ones(solution.weight.size());

  // Ceres projects steps into the box but does not hold a parameter there, which makes the others crawl. Parameters that
  // a bound holds back are therefore taken out between rounds, and let go again when the cost no longer pushes.
  const double unit = data_norm(blocks);
  Blocks cost(blocks, scale, unit, threads);
  StopOnRequest stop(stage, control);
  evaluate(cost, z, parameters, solution);
  if (!solution.defined) {
    solution.termination = fmt::format("no finite value at the start: {} at {}", cost.offender(solution.x),
                                       listed(parameters, solution.x));
    return solution;
  }
  std::vector<int> held = held_by_bounds(solution, parameters);
  if (static_cast<Eigen::Index>(held.size()) == n) held.clear();
  double radius = 1e4;  // Ceres's own start
  for (int round = 0; round < effort.rounds; ++round) {
    const ceres::Solver::Summary summary = solve_round(cost, parameters, held, radius, effort.iterations, stop, z);
    if (control.stop.stop_requested()) throw Interrupted("fit: stopped on request in stage " + stage);
    if (!summary.iterations.empty()) radius = std::clamp(summary.iterations.back().trust_region_radius, 1e2, 1e8);
    solution.iterations += std::max(0, summary.num_successful_steps + summary.num_unsuccessful_steps);
    if (round == 0) solution.initial_cost = summary.initial_cost * unit * unit;
    evaluate(cost, z, parameters, solution);
    if (!solution.defined) throw Error("fit: stage " + stage + " has no finite value at its own solution");
    z = solution.x.cwiseQuotient(scale);
    const std::vector<int> next = held_by_bounds(solution, parameters);
    const bool stopped = summary.termination_type == ceres::CONVERGENCE;
    // Flat valleys, as of a rate that acts on next to nothing, are not walked to their end.
    const bool flat = summary.initial_cost - summary.final_cost <= kSettled * summary.final_cost;
    solution.converged = (stopped || flat) && is_minimum(solution, unit, next);
    solution.final_cost = summary.final_cost * unit * unit;
    solution.termination =
        stopped || !flat
            ? fmt::format("{}: {}", ceres::TerminationTypeToString(summary.termination_type), summary.message)
            : fmt::format("CONVERGENCE: the cost changed by less than {:g} of itself in {} iterations.", kSettled,
                          effort.iterations);
    if (solution.converged) break;
    if (stopped || flat) solution.termination += " (but the gradient does not vanish)";
    if (next == held && stopped) break;  // no better by trying again
    held = next;
  }
  solution.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return solution;
}

Eigen::MatrixXd curvature(const Problem& problem, const Solution& solution, int threads) {
  const Eigen::Index n = solution.x.size(), rows = solution.misfit.size();
  const Eigen::VectorXd w2r = solution.weight.cwiseAbs2().cwiseProduct(solution.misfit);
  const Eigen::VectorXd here = solution.jacobian.transpose() * w2r;
  RowMajor jacobian(rows, n);
  Eigen::VectorXd misfit(rows);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  std::vector<bool> bent(static_cast<std::size_t>(n));  // defined next to the solution
  for (Eigen::Index k = 0; k < n; ++k) {
    const FreeParameter& p = problem.parameters[static_cast<std::size_t>(k)];
    if (solution.at_bound[static_cast<std::size_t>(k)]) continue;
    Eigen::VectorXd x = solution.x;
    x(k) += kCurvatureStep * p.scale;
    if (x(k) > p.upper) x(k) = solution.x(k) - kCurvatureStep * p.scale;
    if (!fit::evaluate(problem.blocks, x, threads, misfit.data(), jacobian.data())) continue;
    bent[static_cast<std::size_t>(k)] = true;
    S.col(k) = (jacobian.transpose() * w2r - here) / (x(k) - solution.x(k));
  }
  const Eigen::VectorXd held = solution.weight.cwiseAbs2().cwiseProduct((1 - solution.pull_slope.array()).matrix());
  const Eigen::MatrixXd unbent = solution.jacobian.transpose() * held.asDiagonal() * solution.jacobian;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (bent[static_cast<std::size_t>(k)]) S.col(k) -= unbent.col(k);
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!bent[static_cast<std::size_t>(k)]) S.row(k).setZero();
  }
  return (S + S.transpose()) / 2;
}

}  // namespace grainlaw::fit
