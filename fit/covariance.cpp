#include "fit/covariance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

namespace grainlaw::fit {
namespace {

constexpr double kNullPart = 1e-4;      // component along a null direction beyond which a parameter is not determined
constexpr double kCarriedByOne = 0.05;  // share of a parameter's variance along directions that one run carries

/// H^+ = L L^T for H = J^T J, by the singular values of J with its columns scaled to one.
struct Factor {
  Eigen::MatrixXd L;
  std::vector<bool> identified;
  double condition = 0;
};

Factor factor_of(const Eigen::MatrixXd& J) {
  const Eigen::Index p = J.cols();
  Factor factor;
  factor.identified.assign(static_cast<std::size_t>(p), true);
  Eigen::VectorXd inverse_norm(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double norm = J.col(k).norm();
    inverse_norm(k) = norm > 0 ? 1 / norm : 0;
    if (!(norm > 0)) factor.identified[static_cast<std::size_t>(k)] = false;
  }
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(J * inverse_norm.asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  Eigen::Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > kNullSingularValue * sigma(0)) ++rank;
  if (rank > 0) factor.condition = sigma(0) / sigma(rank - 1);
  const Eigen::MatrixXd V = svd.matrixV().leftCols(rank);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double null_part = std::sqrt(std::max(0.0, 1 - V.row(k).squaredNorm()));
    if (null_part > kNullPart) factor.identified[static_cast<std::size_t>(k)] = false;
  }
  factor.L = inverse_norm.asDiagonal() * V * sigma.head(rank).cwiseInverse().asDiagonal();
  return factor;
}

constexpr Eigen::Index kPieces = 10;  // of a run: longer than the correlation of its rows, short enough to be many

/// sum of g g^T over the pieces of a run, g = J^T r of a piece; the run is cut in the order of its rows.
Eigen::MatrixXd products_of_pieces(const Eigen::MatrixXd& J, const Eigen::VectorXd& misfit, Eigen::Index together) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  const Eigen::Index groups = (J.rows() + together - 1) / together;
  for (Eigen::Index k = 0; k < kPieces; ++k) {
    const Eigen::Index begin = k * groups / kPieces * together;
    const Eigen::Index n = std::min((k + 1) * groups / kPieces * together, J.rows()) - begin;
    const Eigen::VectorXd g = J.middleRows(begin, n).transpose() * misfit.segment(begin, n);
    sum += g * g.transpose();
  }
  return sum;
}

}  // namespace

ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free,
                                     Eigen::Index rows_together) {
  const auto all = static_cast<std::size_t>(jacobian.cols());
  ClusterCovariance result;
  result.covariance = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  result.identified.assign(all, true);  // a parameter on its bound is known to be there
  result.has_error.assign(all, false);
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < all; ++k) {
    if (free[k]) columns.push_back(static_cast<Eigen::Index>(k));
  }
  const auto p = static_cast<Eigen::Index>(columns.size());
  if (p == 0) return result;
  const Eigen::MatrixXd J = jacobian(Eigen::all, columns);
  const Factor factor = factor_of(J);
  const Eigen::MatrixXd& L = factor.L;
  result.condition = factor.condition;
  if (L.cols() == 0) {  // nothing that was measured moves with any parameter
    for (const Eigen::Index k : columns) result.identified[static_cast<std::size_t>(k)] = false;
    return result;
  }

  std::map<int, std::vector<Eigen::Index>> rows_of;
  for (std::size_t i = 0; i < cluster.size(); ++i) rows_of[cluster[i]].push_back(static_cast<Eigen::Index>(i));
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(L.cols(), L.cols());  // in the coordinates of L
  Eigen::MatrixXd meat_of_pieces = meat;
  Eigen::VectorXd carried_by_one = Eigen::VectorXd::Zero(p);
  for (const auto& [id, rows] : rows_of) {
    const Eigen::MatrixXd J_L = J(rows, Eigen::all) * L;
    // Eigenvalues are those of the run's leverage J_c H^+ J_c^T.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> leverage(J_L.transpose() * J_L);
    const Eigen::MatrixXd& W = leverage.eigenvectors();
    Eigen::VectorXd power(L.cols());
    for (Eigen::Index k = 0; k < L.cols(); ++k) {
      const double h = leverage.eigenvalues()(k);
      power(k) = h < kLargestLeverage ? 1 / std::sqrt(1 - h) : 0;
      if (h >= kLargestLeverage) carried_by_one += (L * W.col(k)).cwiseAbs2();
    }
    const Eigen::VectorXd g = W * power.cwiseProduct(W.transpose() * (J_L.transpose() * misfit(rows)));
    meat += g * g.transpose();
    meat_of_pieces += products_of_pieces(J_L, misfit(rows), rows_together);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> excess(meat_of_pieces - meat);
  const Eigen::MatrixXd& U = excess.eigenvectors();
  meat += U * excess.eigenvalues().cwiseMax(0).asDiagonal() * U.transpose();
  const Eigen::MatrixXd V = L * meat * L.transpose();
  for (Eigen::Index k = 0; k < p; ++k) {
    const auto whole = static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]);
    result.identified[whole] = factor.identified[static_cast<std::size_t>(k)];
    result.has_error[whole] = result.identified[whole] && carried_by_one(k) <= kCarriedByOne * L.row(k).squaredNorm();
  }
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < p; ++j) {
      const Eigen::Index a = columns[static_cast<std::size_t>(i)], b = columns[static_cast<std::size_t>(j)];
      const bool both = result.has_error[static_cast<std::size_t>(a)] && result.has_error[static_cast<std::size_t>(b)];
      if (both) result.covariance(a, b) = V(i, j);
    }
  }
  return result;
}

}  // namespace grainlaw::fit
