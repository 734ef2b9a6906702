#include "fit/statistics/inherited_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/statistics/covariance.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kLinearStep = 1e-6;  // of a parameter; the quotient's own error is about as small, and two digits do

bool has_error(const Eigen::MatrixXd& influence, Eigen::Index k) { return influence.row(k).squaredNorm() > 0; }

/// d(J^T pull), pull = W^2 misfit where nothing holds it, at the stage's solution when the parameters `index` of the law move by each column of `influence`.
Eigen::MatrixXd gradient_changes(
    const std::vector<std::size_t>& index, const Eigen::MatrixXd& influence, const LawParameters<double>& law,
    const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at, int threads,
    const Solution& solution) {
  const Eigen::Index rows = solution.misfit.size(), n = solution.x.size();
  const Eigen::VectorXd w2 = solution.weight.cwiseAbs2();
  const auto pull = [&](const Eigen::VectorXd& misfit) -> Eigen::VectorXd {
    return w2.cwiseProduct(misfit - (1 - solution.pull_slope.array()).matrix().cwiseProduct(misfit - solution.misfit));
  };
  const Eigen::VectorXd here = solution.jacobian.transpose() * pull(solution.misfit);
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(n, influence.cols());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(rows, n);
  Eigen::VectorXd misfit(rows);
  for (Eigen::Index c = 0; c < influence.cols(); ++c) {
    LawParameters<double> moved = law;
    const auto field = fields(moved);
    double largest = 0;  // relative move
    for (std::size_t k = 0; k < index.size(); ++k)
      largest = std::max(
          largest, std::abs(influence(static_cast<Eigen::Index>(k), c)) / std::max(std::abs(*field[index[k]]), 1e-3));
    if (!(largest > 0)) continue;
    const double part = kLinearStep / largest;
    for (std::size_t k = 0; k < index.size(); ++k)
      *field[index[k]] += part * influence(static_cast<Eigen::Index>(k), c);
    if (evaluate(blocks_at(moved), solution.x, threads, misfit.data(), jacobian.data()))
      change.col(c) = (jacobian.transpose() * pull(misfit) - here) / part;
  }
  return change;
}

/// Adds the response to the changes of the gradient (parameters x packings) to the errors of `second`. Degrees of freedom at
/// most the least of `given`, those of the parameters that caused them.
void add_response(const Eigen::MatrixXd& gradient_change, const Eigen::VectorXd& given, StageFit& second) {
  const Solution& solution = second.solution;
  std::vector<bool> free(solution.at_bound);
  free.flip();
  const Eigen::MatrixXd moved =
      response(solution.weight.asDiagonal() * solution.jacobian, free, gradient_change, solution.curvature);
  widen(second.influence, moved.cols());
  for (Eigen::Index i = 0; i < second.influence.rows(); ++i) {
    Estimate& estimate = second.stage.estimates[static_cast<std::size_t>(i)].estimate;
    if (!std::isfinite(estimate.standard_error)) continue;
    second.influence.row(i).head(moved.cols()) += moved.row(i);
    estimate.standard_error = second.influence.row(i).norm();
    estimate.degrees_of_freedom = std::min(estimate.degrees_of_freedom, given.minCoeff());
  }
}

}  // namespace

FoundErrors no_errors() {
  constexpr auto n = static_cast<Eigen::Index>(kParameterCount);
  return {Eigen::MatrixXd::Zero(n, 0), Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN())};
}

void widen(Eigen::MatrixXd& influence, Eigen::Index packings) {
  const Eigen::Index before = influence.cols();
  if (before >= packings) return;
  influence.conservativeResize(Eigen::NoChange, packings);
  influence.rightCols(packings - before).setZero();
}

void add_errors(const StageFit& fit, FoundErrors& found) {
  widen(found.influence, fit.influence.cols());
  for (std::size_t k = 0; k < fit.stage.estimates.size(); ++k) {
    const auto& [name, estimate] = fit.stage.estimates[k];
    const auto i = static_cast<Eigen::Index>(parameter_index(name)), row = static_cast<Eigen::Index>(k);
    found.degrees_of_freedom(i) = estimate.degrees_of_freedom;
    found.influence.row(i).setZero();
    if (row < fit.influence.rows()) found.influence.row(i).head(fit.influence.cols()) = fit.influence.row(row);
  }
}

void inherit_errors(const std::vector<std::string>& given, const FoundErrors& found, const LawParameters<double>& law,
                    const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at,
                    int threads, StageFit& second) {
  if (!second.solution.defined || found.influence.cols() == 0) return;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name, group = name.substr(0, name.find('.'));
    const bool takes = std::ranges::any_of(given, [&](const std::string& g) { return g == name || g == group; });
    if (takes && has_error(found.influence, static_cast<Eigen::Index>(i))) index.push_back(i);
  }
  if (index.empty()) return;
  add_response(gradient_changes(index, found.influence(index, Eigen::all), law, blocks_at, threads, second.solution),
               found.degrees_of_freedom(index), second);
}

}  // namespace grainlaw::fit
