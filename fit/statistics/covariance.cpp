#include "fit/statistics/covariance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace grainlaw::fit {
namespace {

constexpr double kNullPart = 1e-4;      // component along a null direction beyond which a parameter is not determined
constexpr double kCarriedByOne = 0.05;  // share of a parameter's variance along directions that one packing carries
// Second derivative of the cost over that without curvature; outside, the misfits alone make a valley or a hill of it.
constexpr double kFlattest = 0.1, kSteepest = 10;

std::vector<Eigen::Index> columns_of(const std::vector<bool>& free) {
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k]) columns.push_back(static_cast<Eigen::Index>(k));
  }
  return columns;
}

/// H^+ = L L^T for H = J^T J, by the singular values of J with its columns scaled to one, and A^+ = B L^T = L M^-1 L^T with
/// M = 1 + L^T S L, in these coordinates the Hessian of the cost.
struct Factor {
  Eigen::MatrixXd L, B;
  std::vector<bool> identified;
};

/// M^-1 with its eigenvalues, positive at a minimum, held within bounds.
Eigen::MatrixXd inverse_hessian(const Eigen::MatrixXd& M) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(M);
  const Eigen::MatrixXd& W = solver.eigenvectors();
  return W * solver.eigenvalues().cwiseMax(kFlattest).cwiseMin(kSteepest).cwiseInverse().asDiagonal() * W.transpose();
}

/// R of J = Q R, square: rows of zeros where J has less rows than columns.
Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& J) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(J);
  const Eigen::Index rows = std::min(J.rows(), J.cols());
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  R.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return R;
}

/// `S` of the columns of `J`, or empty.
Factor factor_of(const Eigen::MatrixXd& J, const Eigen::MatrixXd& S) {
  const Eigen::Index p = J.cols();
  Factor factor;
  factor.identified.assign(static_cast<std::size_t>(p), true);
  Eigen::VectorXd inverse_norm(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double norm = J.col(k).norm();
    inverse_norm(k) = norm > 0 ? 1 / norm : 0;
    if (!(norm > 0)) factor.identified[static_cast<std::size_t>(k)] = false;
  }
  // Those of R; Jacobi's rotations alone are the part of the decomposition that is quick to compile.
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(triangle_of(J * inverse_norm.asDiagonal()),
                                                                         Eigen::ComputeFullV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  Eigen::Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > kNullSingularValue * sigma(0)) ++rank;
  const Eigen::MatrixXd V = svd.matrixV().leftCols(rank);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double null_part = std::sqrt(std::max(0.0, 1 - V.row(k).squaredNorm()));
    if (null_part > kNullPart) factor.identified[static_cast<std::size_t>(k)] = false;
  }
  const Eigen::MatrixXd& L = factor.L = inverse_norm.asDiagonal() * V * sigma.head(rank).cwiseInverse().asDiagonal();
  factor.B = L;
  if (S.size() > 0 && rank > 0)
    factor.B = L * inverse_hessian(Eigen::MatrixXd::Identity(rank, rank) + L.transpose() * S * L);
  return factor;
}

/// Of the free parameters.
Factor factor_of(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& curvature,
                 const std::vector<Eigen::Index>& columns) {
  return factor_of(jacobian(Eigen::all, columns),
                   curvature.size() > 0 ? Eigen::MatrixXd(curvature(columns, columns)) : Eigen::MatrixXd());
}

/// What a packing shows in the coordinates of L.
struct Packing {
  Eigen::MatrixXd Q;      ///< information, eigenvalues are those of its leverage J_c H^+ J_c^T
  Eigen::MatrixXd power;  ///< (1 - Q)^(-1/2), zero along directions that it carries alone
  Eigen::MatrixXd alone;  ///< these directions, orthonormal columns
  Eigen::VectorXd g;      ///< power J_c^T r_c
};

Packing packing_of(const Eigen::MatrixXd& J_L, const Eigen::VectorXd& misfit) {
  Packing packing;
  packing.Q = J_L.transpose() * J_L;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> leverage(packing.Q);
  std::vector<Eigen::Index> alone;
  Eigen::VectorXd power(J_L.cols());
  for (Eigen::Index k = 0; k < power.size(); ++k) {
    const double h = leverage.eigenvalues()(k);
    power(k) = h < kLargestLeverage ? 1 / std::sqrt(1 - h) : 0;
    if (h >= kLargestLeverage) alone.push_back(k);
  }
  const Eigen::MatrixXd& W = leverage.eigenvectors();
  packing.power = W * power.asDiagonal() * W.transpose();
  packing.alone = W(Eigen::all, alone);
  packing.g = packing.power * (J_L.transpose() * misfit);
  return packing;
}

/// Of the variance of u^T g, u a row of B: g_cd = delta_cd a_c^T Q_c a_c - (Q_c a_c)^T (Q_d a_d), a_c = power_c u.
double satterthwaite(const std::map<int, Packing>& packings, const Eigen::VectorXd& u) {
  const auto n = static_cast<Eigen::Index>(packings.size());
  Eigen::MatrixXd q(u.size(), n);
  Eigen::VectorXd own(n);
  Eigen::Index c = 0;
  for (const auto& [id, packing] : packings) {
    const Eigen::VectorXd a = packing.power * u;
    q.col(c) = packing.Q * a;
    own(c) = a.dot(q.col(c));
    ++c;
  }
  Eigen::MatrixXd g = -q.transpose() * q;
  g.diagonal() += own;
  return std::max(1.0, g.trace() * g.trace() / g.squaredNorm());  // at least one, but for rounding
}

}  // namespace

ClusterCovariance cluster_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& misfit,
                                     const std::vector<int>& cluster, const std::vector<bool>& free,
                                     const Eigen::MatrixXd& curvature) {
  const auto all = static_cast<std::size_t>(jacobian.cols());
  const int packing_count = cluster.empty() ? 0 : 1 + *std::max_element(cluster.begin(), cluster.end());
  ClusterCovariance result;
  result.influence = Eigen::MatrixXd::Zero(jacobian.cols(), packing_count);
  result.degrees_of_freedom = Eigen::VectorXd::Constant(jacobian.cols(), std::numeric_limits<double>::quiet_NaN());
  result.identified.assign(all, true);  // a parameter on its bound is known to be there
  result.has_error.assign(all, false);
  const std::vector<Eigen::Index> columns = columns_of(free);
  if (columns.empty()) return result;
  const Eigen::MatrixXd J = jacobian(Eigen::all, columns);
  const Factor factor = factor_of(jacobian, curvature, columns);
  const Eigen::MatrixXd &L = factor.L, &B = factor.B;
  if (L.cols() == 0) {  // nothing that was measured moves with any parameter
    for (const Eigen::Index k : columns) result.identified[static_cast<std::size_t>(k)] = false;
    return result;
  }

  std::map<int, std::vector<Eigen::Index>> rows_of;
  for (std::size_t i = 0; i < cluster.size(); ++i) rows_of[cluster[i]].push_back(static_cast<Eigen::Index>(i));
  std::map<int, Packing> packings;
  Eigen::VectorXd carried_by_one = Eigen::VectorXd::Zero(L.rows());
  for (const auto& [id, rows] : rows_of) {
    const Packing& packing = packings[id] = packing_of(J(rows, Eigen::all) * L, misfit(rows));
    carried_by_one += (B * packing.alone).rowwise().squaredNorm();
  }
  for (Eigen::Index k = 0; k < L.rows(); ++k) {
    const Eigen::Index whole = columns[static_cast<std::size_t>(k)];
    const auto at = static_cast<std::size_t>(whole);
    result.identified[at] = factor.identified[static_cast<std::size_t>(k)];
    result.has_error[at] = result.identified[at] && carried_by_one(k) <= kCarriedByOne * B.row(k).squaredNorm();
    if (!result.has_error[at]) continue;
    for (const auto& [id, packing] : packings) result.influence(whole, id) = -B.row(k).dot(packing.g);
    result.degrees_of_freedom(whole) = satterthwaite(packings, B.row(k));
  }
  return result;
}

Eigen::MatrixXd response(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free, const Eigen::MatrixXd& change,
                         const Eigen::MatrixXd& curvature) {
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(jacobian.cols(), change.cols());
  const std::vector<Eigen::Index> columns = columns_of(free);
  if (columns.empty()) return moved;
  const Factor factor = factor_of(jacobian, curvature, columns);
  moved(columns, Eigen::all) = -factor.B * (factor.L.transpose() * change(columns, Eigen::all));
  return moved;
}

Eigen::VectorXd naive_variance(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free,
                               const Eigen::MatrixXd& curvature) {
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(jacobian.cols());
  const std::vector<Eigen::Index> columns = columns_of(free);
  if (columns.empty()) return variance;
  const Factor factor = factor_of(jacobian, curvature, columns);
  variance(columns) = factor.B.cwiseProduct(factor.L).rowwise().sum();
  return variance;
}

}  // namespace grainlaw::fit
