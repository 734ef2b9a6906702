#include "fit/covariance.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

namespace grainlaw::fit {
namespace {

struct PseudoInverse {
  Eigen::MatrixXd H_plus;  ///< of J^T J
  std::vector<bool> identified;
  double condition = 0;
};

PseudoInverse pseudo_inverse(const Eigen::MatrixXd& J) {
  const Eigen::Index p = J.cols();
  PseudoInverse result;
  result.identified.assign(static_cast<std::size_t>(p), true);
  Eigen::VectorXd inverse_norm(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double norm = J.col(k).norm();
    inverse_norm(k) = norm > 0 ? 1 / norm : 0;
    if (!(norm > 0)) result.identified[static_cast<std::size_t>(k)] = false;
  }
  const Eigen::MatrixXd scaled = J * inverse_norm.asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  Eigen::VectorXd inverse_square = Eigen::VectorXd::Zero(sigma.size());
  Eigen::MatrixXd null_part = Eigen::MatrixXd::Identity(p, p);
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (sigma(i) > kNullSingularValue * sigma(0)) {
      inverse_square(i) = 1 / (sigma(i) * sigma(i));
      null_part -= svd.matrixV().col(i) * svd.matrixV().col(i).transpose();
      result.condition = sigma(0) / sigma(i);
    }
  }
  // A parameter is determined when no null direction moves it.
  for (Eigen::Index k = 0; k < p; ++k) {
    if (std::sqrt(std::max(0.0, null_part(k, k))) > 1e-4) result.identified[static_cast<std::size_t>(k)] = false;
  }
  const Eigen::MatrixXd V = inverse_norm.asDiagonal() * svd.matrixV();
  result.H_plus = V * inverse_square.asDiagonal() * V.transpose();
  return result;
}

constexpr Eigen::Index kPieces = 10;  // of a run: longer than the correlation of its rows, short enough to be many

/// sum over pieces of g g^T, g = J^T r of the piece; `rows` of each run are cut into `pieces` in their order.
Eigen::MatrixXd score_products(const Eigen::MatrixXd& J, const Eigen::VectorXd& misfit,
                               const std::map<int, std::vector<Eigen::Index>>& rows_of, Eigen::Index pieces) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  for (const auto& [id, rows] : rows_of) {
    const auto n = static_cast<Eigen::Index>(rows.size());
    for (Eigen::Index k = 0; k < pieces; ++k) {
      Eigen::VectorXd g = Eigen::VectorXd::Zero(J.cols());
      for (Eigen::Index i = k * n / pieces; i < (k + 1) * n / pieces; ++i) {
        const Eigen::Index row = rows[static_cast<std::size_t>(i)];
        g += J.row(row).transpose() * misfit(row);
      }
      sum += g * g.transpose();
    }
  }
  return sum;
}

}  // namespace

ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free) {
  const auto all = static_cast<std::size_t>(jacobian.cols());
  ClusterCovariance result;
  result.covariance = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  result.effective_runs = Eigen::VectorXd::Zero(jacobian.cols());
  result.identified.assign(all, false);
  result.has_error.assign(all, false);

  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < all; ++k) {
    if (free[k])
      columns.push_back(static_cast<Eigen::Index>(k));
    else
      result.identified[k] = true;  // a parameter on its bound is known to be there
  }
  const auto p = static_cast<Eigen::Index>(columns.size());
  if (p == 0 || jacobian.rows() == 0) return result;
  const Eigen::MatrixXd J = jacobian(Eigen::all, columns);
  const PseudoInverse inverse = pseudo_inverse(J);
  result.condition = inverse.condition;

  std::map<int, std::vector<Eigen::Index>> rows_of;
  for (std::size_t i = 0; i < cluster.size(); ++i) rows_of[cluster[i]].push_back(static_cast<Eigen::Index>(i));
  Eigen::VectorXd share_squared = Eigen::VectorXd::Zero(p);
  for (const auto& [id, rows] : rows_of) {
    const Eigen::MatrixXd J_c = J(rows, Eigen::all);
    const Eigen::MatrixXd spread = J_c * inverse.H_plus;
    for (Eigen::Index k = 0; k < p; ++k) {
      if (inverse.H_plus(k, k) > 0) {
        share_squared(k) += std::pow(spread.col(k).squaredNorm() / inverse.H_plus(k, k), 2);
      }
    }
  }
  const Eigen::MatrixXd V0 = inverse.H_plus * score_products(J, misfit, rows_of, 1) * inverse.H_plus;
  const Eigen::MatrixXd V0_pieces = inverse.H_plus * score_products(J, misfit, rows_of, kPieces) * inverse.H_plus;
  const double n = static_cast<double>(J.rows()), dof = n - static_cast<double>(p);
  Eigen::VectorXd factor = Eigen::VectorXd::Zero(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const auto whole = static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]);
    result.identified[whole] = inverse.identified[static_cast<std::size_t>(k)];
    if (!result.identified[whole]) continue;
    const double G = share_squared(k) > 0 ? 1 / share_squared(k) : 0;
    result.effective_runs(static_cast<Eigen::Index>(whole)) = G;
    if (G > kLeastEffectiveRuns && dof > 0) {
      result.has_error[whole] = true;
      factor(k) = std::sqrt(G / (G - 1) * (n - 1) / dof);
    }
  }
  Eigen::MatrixXd V = factor.asDiagonal() * V0 * factor.asDiagonal();
  for (Eigen::Index k = 0; k < p; ++k) {
    if (factor(k) > 0) V(k, k) = std::max(V(k, k), V0_pieces(k, k) * (n - 1) / dof);
  }
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < p; ++j) {
      result.covariance(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]) = V(i, j);
    }
  }
  return result;
}

}  // namespace grainlaw::fit
