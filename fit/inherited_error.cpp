#include "fit/inherited_error.hpp"

#include <algorithm>
#include <cmath>

#include "fit/covariance.hpp"

namespace grainlaw::fit {
namespace {

// Of the first stage's rows over the second's: its square is lost from the influence of the second on the first, and no
// digit of the singular values, which are those of columns scaled to one.
constexpr double kDominance = 1e5;

std::vector<bool> free_of(const Solution& solution) {
  std::vector<bool> free(solution.at_bound);
  free.flip();
  return free;
}

}  // namespace

void inherit_error(const StageFit& first, const std::string& parameter, const Eigen::VectorXd& slope,
                   StageFit& second) {
  const auto named = [&](const NamedEstimate& e) { return e.name == parameter; };
  const auto& given = first.stage.estimates;
  const auto k = std::find_if(given.begin(), given.end(), named) - given.begin();
  const Solution &a = first.solution, &b = second.solution;
  if (!a.defined || !b.defined || !std::isfinite(given.at(static_cast<std::size_t>(k)).estimate.standard_error)) return;

  const Eigen::VectorXd inherited = b.weight.cwiseProduct(slope);
  const double dominance = kDominance * inherited.norm() / a.weight.cwiseProduct(a.jacobian.col(k)).norm();
  if (!(dominance > 0) || !std::isfinite(dominance)) return;
  const Eigen::Index n_a = a.x.size(), n_b = b.x.size(), rows_a = a.weight.size(), rows_b = b.weight.size();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows_a + rows_b, n_a + n_b);
  Eigen::VectorXd misfit(rows_a + rows_b);
  std::vector<int> cluster;
  // Rows of both stages by turns. Both read the same rows of the data, so that two by two belong together.
  for (Eigen::Index i = 0, row = 0; i < std::max(rows_a, rows_b); ++i) {
    if (i < rows_a) {
      J.row(row).head(n_a) = dominance * a.weight(i) * a.jacobian.row(i);
      misfit(row++) = dominance * a.weight(i) * a.misfit(i);
      cluster.push_back(a.cluster[static_cast<std::size_t>(i)]);
    }
    if (i < rows_b) {
      J(row, k) = inherited(i);
      J.row(row).tail(n_b) = b.weight(i) * b.jacobian.row(i);
      misfit(row++) = b.weight(i) * b.misfit(i);
      cluster.push_back(b.cluster[static_cast<std::size_t>(i)]);
    }
  }
  std::vector<bool> free = free_of(a);
  const std::vector<bool> free_b = free_of(b);
  free.insert(free.end(), free_b.begin(), free_b.end());
  const ClusterCovariance errors = cluster_covariance(J, misfit, cluster, free, rows_a == rows_b ? 2 : 1);
  for (Eigen::Index i = 0; i < n_b; ++i) {
    Estimate& estimate = second.stage.estimates[static_cast<std::size_t>(i)].estimate;
    if (!std::isfinite(estimate.standard_error) || !errors.has_error[static_cast<std::size_t>(n_a + i)]) continue;
    estimate.standard_error = std::sqrt(errors.covariance(n_a + i, n_a + i));
    for (Eigen::Index j = 0; j < n_b; ++j) {
      if (second.covariance(i, i) > 0 && second.covariance(j, j) > 0)
        second.covariance(i, j) = second.covariance(j, i) = errors.covariance(n_a + i, n_a + j);
    }
  }
}

}  // namespace grainlaw::fit
