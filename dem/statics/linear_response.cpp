#include "dem/statics/linear_response.hpp"

#include <algorithm>
#include <limits>

namespace grainlaw::dem {
namespace {

constexpr double kTolerance = 1e-11;  // residual of the six solutions over their right-hand sides
constexpr int kMaxIterations = 100000;

/// Forces that the spheres' following the strain g leaves on them.
Eigen::Matrix3Xd affine_forces(const std::vector<NetworkContact>& contacts, double k, const Eigen::Matrix3d& g,
                               Eigen::Index spheres) {
  Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, spheres);
  for (const NetworkContact& c : contacts) {
    const Eigen::Vector3d t = contact_stiffness(c, k) * (g * (c.d * c.n));
    f.col(c.i) -= t;
    f.col(c.j) += t;
  }
  return f;
}

Eigen::Matrix3d stress_change(const std::vector<NetworkContact>& contacts, double k, double volume,
                              const Eigen::Matrix3d& g, const Eigen::Matrix3Xd& u) {
  Eigen::Matrix3d change = -g.trace() * volume * stress_of(contacts, k, volume);
  for (const NetworkContact& c : contacts) {
    const Eigen::Vector3d l = c.d * c.n, dl = g * l + u.col(c.i) - u.col(c.j);
    const double stretch = c.n.dot(dl);
    const Eigen::Matrix3d turned = dl * l.transpose();
    // d(delta/d) = -(1 + delta/d) stretch/d
    change +=
        k * (-(1 + c.delta / c.d) * stretch / c.d * l * l.transpose() + c.delta / c.d * (turned + turned.transpose()));
  }
  return change / volume;
}

}  // namespace

Vector6 stress_coordinates(const Eigen::Matrix3d& sigma) {
  Vector6 coordinates;
  coordinates << sigma.trace() / 3, deviator<double>(sigma);
  return coordinates;
}

Eigen::Matrix3d strain_of(const Vector6& coordinates) {
  const Deviator<double> e = coordinates.tail<5>();
  return -coordinates[0] / 3 * Eigen::Matrix3d::Identity() - tensor_of<double>(e);
}

LinearResponse linear_response(const Packing& packing, const std::vector<NetworkContact>& contacts, double stiffness,
                               const std::stop_token& stop) {
  const auto spheres = static_cast<Eigen::Index>(packing.size());
  const double volume = packing.volume();
  LinearResponse response;
  for (int a = 0; a < 6; ++a) {
    const Eigen::Matrix3d g = strain_of(Vector6::Unit(a));
    const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, spheres);
    response.affine.col(a) = stress_coordinates(stress_change(contacts, stiffness, volume, g, none));
    StiffnessSolution solution = solve_stiffness(contacts, stiffness, affine_forces(contacts, stiffness, g, spheres),
                                                 kTolerance, kMaxIterations, stop);
    response.relaxed.col(a) = stress_coordinates(stress_change(contacts, stiffness, volume, g, solution.u));
    response.iterations += solution.iterations;
    response.end = std::max(response.end, solution.end);
    response.u.push_back(std::move(solution.u));
  }
  if (response.end != SolveEnd::solved) response.relaxed.setConstant(std::numeric_limits<double>::quiet_NaN());
  return response;
}

}  // namespace grainlaw::dem
