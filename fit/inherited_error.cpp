#include "fit/inherited_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/covariance.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kStep = 1e-6;  // of a parameter; the quotient's own error is about as small, errors need two digits

bool has_error(const Eigen::MatrixXd& influence, Eigen::Index k) { return influence.row(k).squaredNorm() > 0; }

/// Of the parameters `index` that have an error: d misfit/d parameter of all rows at the stage's solution.
Eigen::MatrixXd slopes(const std::vector<std::size_t>& index, const LawParameters<double>& law,
                       const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at,
                       const Solution& solution) {
  Eigen::MatrixXd slope(solution.misfit.size(), static_cast<Eigen::Index>(index.size()));
  for (std::size_t k = 0; k < index.size(); ++k) {
    LawParameters<double> moved = law;
    double& value = *fields(moved)[index[k]];
    const double before = value;
    value -= kStep * std::max(std::abs(value), 1e-3);  // downwards: a jamming density then leaves the data further away
    Eigen::VectorXd misfit(solution.misfit.size());
    Eigen::Index first = 0;
    for (const ResidualBlock& block : blocks_at(moved)) {
      if (!block.evaluate(solution.x.data(), misfit.data() + first, nullptr))
        misfit.segment(first, block.rows()) = solution.misfit.segment(first, block.rows());
      first += block.rows();
    }
    slope.col(static_cast<Eigen::Index>(k)) = (misfit - solution.misfit) / (value - before);
  }
  return slope;
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

void inherit_error(const Eigen::MatrixXd& slope, const Eigen::MatrixXd& influence,
                   const Eigen::VectorXd& degrees_of_freedom, StageFit& second) {
  const Solution& solution = second.solution;
  if (!solution.defined || influence.squaredNorm() == 0) return;
  std::vector<bool> free(solution.at_bound);
  free.flip();
  const auto& w = solution.weight;
  const Eigen::MatrixXd moved = response(w.asDiagonal() * solution.jacobian, free, w.asDiagonal() * slope) * influence;
  widen(second.influence, influence.cols());
  for (Eigen::Index i = 0; i < second.influence.rows(); ++i) {
    Estimate& estimate = second.stage.estimates[static_cast<std::size_t>(i)].estimate;
    if (!std::isfinite(estimate.standard_error)) continue;
    second.influence.row(i).head(influence.cols()) += moved.row(i);
    estimate.standard_error = second.influence.row(i).norm();
    for (Eigen::Index k = 0; k < influence.rows(); ++k) {
      if (has_error(influence, k))
        estimate.degrees_of_freedom = std::min(estimate.degrees_of_freedom, degrees_of_freedom(k));
    }
  }
}

void inherit_error(const std::vector<std::string>& groups, const FoundErrors& found, const LawParameters<double>& law,
                   const std::function<std::vector<ResidualBlock>(const LawParameters<double>&)>& blocks_at,
                   StageFit& second) {
  if (!second.solution.defined || found.influence.cols() == 0) return;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name, group = name.substr(0, name.find('.'));
    const bool given = std::find(groups.begin(), groups.end(), group) != groups.end();
    if (given && has_error(found.influence, static_cast<Eigen::Index>(i))) index.push_back(i);
  }
  if (index.empty()) return;
  inherit_error(slopes(index, law, blocks_at, second.solution), found.influence(index, Eigen::all),
                found.degrees_of_freedom(index), second);
}

}  // namespace grainlaw::fit
