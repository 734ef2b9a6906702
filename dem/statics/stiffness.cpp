#include "dem/statics/stiffness.hpp"

#include <Eigen/Cholesky>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

using Displacements = Eigen::Matrix3Xd;

double dot(const Displacements& a, const Displacements& b) { return a.cwiseProduct(b).sum(); }

/// Inverses of the blocks K_ii; of a block that is not positive, of its diagonal's bound instead.
std::vector<Eigen::Matrix3d> inverse_blocks(const std::vector<NetworkContact>& contacts, double k,
                                            Eigen::Index spheres) {
  std::vector<Eigen::Matrix3d> blocks(static_cast<std::size_t>(spheres), Eigen::Matrix3d::Zero());
  for (const NetworkContact& c : contacts) {
    if (c.i == c.j) continue;  // an own image moves along
    const Eigen::Matrix3d M = contact_stiffness(c, k);
    blocks[c.i] += M;
    blocks[c.j] += M;
  }
  for (Eigen::Matrix3d& block : blocks) {
    const Eigen::LLT<Eigen::Matrix3d> factor(block);
    block = factor.info() == Eigen::Success ? Eigen::Matrix3d(factor.solve(Eigen::Matrix3d::Identity()))
                                            : Eigen::Matrix3d(Eigen::Matrix3d::Identity() / k);
  }
  return blocks;
}

Displacements precondition(const std::vector<Eigen::Matrix3d>& inverse, const Displacements& r) {
  Displacements z(3, r.cols());
  for (Eigen::Index i = 0; i < r.cols(); ++i) z.col(i) = inverse[static_cast<std::size_t>(i)] * r.col(i);
  return z;
}

}  // namespace

Eigen::Matrix3d contact_stiffness(const NetworkContact& c, double k) {
  const double bent = c.delta / c.d;
  return k * ((1 + bent) * c.n * c.n.transpose() - bent * Eigen::Matrix3d::Identity());
}

Displacements stiffness_times(const std::vector<NetworkContact>& contacts, double k, const Displacements& u) {
  Displacements f = Displacements::Zero(3, u.cols());
  for (const NetworkContact& c : contacts) {
    const Eigen::Vector3d w = u.col(c.i) - u.col(c.j);
    const double bent = c.delta / c.d;
    const Eigen::Vector3d t = k * ((1 + bent) * c.n.dot(w) * c.n - bent * w);
    f.col(c.i) += t;
    f.col(c.j) -= t;
  }
  return f;
}

StiffnessSolution solve_stiffness(const std::vector<NetworkContact>& contacts, double k, const Displacements& f,
                                  double tolerance, int max_iterations, const std::stop_token& stop) {
  StiffnessSolution solution;
  Displacements& u = solution.u = Displacements::Zero(3, f.cols());
  const double target = tolerance * f.norm();
  if (f.norm() == 0) return solution;
  const std::vector<Eigen::Matrix3d> inverse = inverse_blocks(contacts, k, f.cols());
  Displacements r = f, z = precondition(inverse, r), p = z;
  double rz = dot(r, z);
  while (r.norm() > target) {
    if (stop.stop_requested()) throw Interrupted("equilibrium: interrupted on request");
    if (solution.iterations == max_iterations) {
      solution.end = SolveEnd::too_long;
      break;
    }
    const Displacements Kp = stiffness_times(contacts, k, p);
    const double curvature = dot(p, Kp);
    if (!(curvature > 0)) {
      solution.end = SolveEnd::not_positive;
      break;
    }
    const double alpha = rz / curvature;
    u += alpha * p;
    r -= alpha * Kp;
    z = precondition(inverse, r);
    const double next = dot(r, z);
    p = z + (next / rz) * p;
    rz = next;
    ++solution.iterations;
  }
  const Eigen::Vector3d drift = u.rowwise().mean();
  u.colwise() -= drift;
  return solution;
}

}  // namespace grainlaw::dem
