#include "model/vocabulary/tensor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "model/vocabulary/portable.hpp"

namespace grainlaw {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix3d traceless(const Eigen::Matrix3d& a) {
  return 0.5 * (a + a.transpose()) - (a.trace() / 3) * Eigen::Matrix3d::Identity();
}

/// A deviator below the rounding of its own tensor is none.
bool has_deviator(const Eigen::Matrix3d& a, const Eigen::Matrix3d& dev) {
  return dev.norm() > 1e-14 * a.norm() && std::isfinite(dev.norm());
}

}  // namespace

double shape_factor(const Eigen::Matrix3d& a) {
  const Eigen::Matrix3d dev = traceless(a);
  if (!has_deviator(a, dev)) return kNaN;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(dev, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d ascending = solver.eigenvalues();
  return ascending(1) / ascending(2);
}

double lode_angle(const Eigen::Matrix3d& a, bool portable) {
  const Eigen::Matrix3d dev = traceless(a);
  if (!has_deviator(a, dev)) return kNaN;
  const double j2 = 0.5 * dev.squaredNorm();
  const double j3 = dev.determinant();
  const double cosine = std::clamp(1.5 * std::numbers::sqrt3 * j3 / (j2 * std::sqrt(j2)), -1.0, 1.0);
  return (portable ? portable::acos(cosine) : std::acos(cosine)) / 3 * 180 / std::numbers::pi;
}

}  // namespace grainlaw
