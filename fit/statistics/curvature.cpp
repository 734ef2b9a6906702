#include "fit/statistics/curvature.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kStep = 1e-6;  // of a parameter's scale

}  // namespace

Eigen::MatrixXd curvature(const std::vector<FreeParameter>& parameters, const std::vector<ResidualBlock>& blocks,
                          const Solution& solution, int threads) {
  const Eigen::Index n = solution.x.size(), rows = solution.misfit.size();
  const Eigen::VectorXd w2r = solution.weight.cwiseAbs2().cwiseProduct(solution.misfit);
  const Eigen::VectorXd here = solution.jacobian.transpose() * w2r;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(rows, n);
  Eigen::VectorXd misfit(rows);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  std::vector<bool> bent(static_cast<std::size_t>(n));  // defined next to the solution
  for (Eigen::Index k = 0; k < n; ++k) {
    const FreeParameter& p = parameters[static_cast<std::size_t>(k)];
    if (solution.at_bound[static_cast<std::size_t>(k)]) continue;
    Eigen::VectorXd x = solution.x;
    x(k) += kStep * p.scale;
    if (x(k) > p.upper) x(k) = solution.x(k) - kStep * p.scale;
    if (!evaluate(blocks, x, threads, misfit.data(), jacobian.data())) continue;
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
