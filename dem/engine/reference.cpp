#include "dem/engine/reference.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace grainlaw::dem {
namespace {

Eigen::Vector3d fraction(const Packing& p, std::size_t i) { return {p.sx[i], p.sy[i], p.sz[i]}; }
Eigen::Vector3d velocity(const Packing& p, std::size_t i) { return {p.vx[i], p.vy[i], p.vz[i]}; }

/// Distance between opposite faces of the cell, for each pair of faces [m].
Eigen::Vector3d face_distances(const Eigen::Matrix3d& H) {
  const double volume = std::abs(H.determinant());
  return {volume / H.col(1).cross(H.col(2)).norm(), volume / H.col(2).cross(H.col(0)).norm(),
          volume / H.col(0).cross(H.col(1)).norm()};
}

bool first_of_opposites(const Eigen::Vector3i& n) {
  if (n.z() != 0) return n.z() > 0;
  if (n.y() != 0) return n.y() > 0;
  return n.x() > 0;
}

}  // namespace

std::vector<ReferencePair> reference_pairs(const Packing& packing, double reach) {
  std::vector<ReferencePair> pairs;
  const Eigen::Vector3d face = face_distances(packing.H);
  for (std::size_t i = 0; i < packing.size(); ++i) {
    for (std::size_t j = i; j < packing.size(); ++j) {
      const double limit = packing.radius[i] + packing.radius[j] + reach;
      const Eigen::Vector3d ds = fraction(packing, i) - fraction(packing, j);
      // |x_ij| < limit needs |ds - n| < limit/face along each axis; one more image on each side guards the rounding.
      const Eigen::Vector3i low = (ds - limit * face.cwiseInverse()).array().floor().cast<int>() - 1;
      const Eigen::Vector3i high = (ds + limit * face.cwiseInverse()).array().ceil().cast<int>() + 1;
      for (int nx = low.x(); nx <= high.x(); ++nx) {
        for (int ny = low.y(); ny <= high.y(); ++ny) {
          for (int nz = low.z(); nz <= high.z(); ++nz) {
            const Eigen::Vector3i n(nx, ny, nz);
            if (i == j && !first_of_opposites(n)) continue;
            const Eigen::Vector3d x = packing.H * (ds - n.cast<double>());
            if (x.norm() < limit) pairs.push_back({i, j, n, x});
          }
        }
      }
    }
  }
  return pairs;
}

ReferenceSums reference_sums(const Packing& packing, const Material& material, const CellMotion& motion) {
  ReferenceSums sums;
  sums.force.assign(packing.size(), Eigen::Vector3d::Zero());
  sums.contacts.assign(packing.size(), 0);
  const auto solid = [&](std::size_t i) { return 4.0 / 3.0 * std::numbers::pi * std::pow(packing.radius[i], 3); };
  const double volume = packing.H.determinant();

  for (const ReferencePair& pair : reference_pairs(packing, 0)) {
    const double distance = pair.x_ij.norm();
    const double delta = packing.radius[pair.i] + packing.radius[pair.j] - distance;
    const Eigen::Vector3d n = pair.x_ij / distance;
    Eigen::Vector3d carried;  // relative velocity that the moving cell gives to the two
    if (motion.transport == Transport::homogeneous) {
      carried = motion.L * pair.x_ij;
    } else {
      const Eigen::Vector3d cells_apart =  // spheres sit in the cell, their images in others
          fraction(packing, pair.i).array().floor() - fraction(packing, pair.j).array().floor() -
          pair.image.cast<double>().array();
      carried = motion.L * packing.H * cells_apart;
    }
    const Eigen::Vector3d u = velocity(packing, pair.i) - velocity(packing, pair.j) + carried;
    const double delta_rate = -u.dot(n);
    const double f = material.stiffness * delta + material.contact_viscosity * delta_rate;

    sums.force[pair.i] += f * n;
    sums.force[pair.j] -= f * n;
    sums.contacts[pair.i] += 1;
    sums.contacts[pair.j] += 1;
    sums.virial += f * n * pair.x_ij.transpose();
    sums.fabric += (solid(pair.i) + solid(pair.j)) / volume * n * n.transpose();
    sums.E_pot += 0.5 * material.stiffness * delta * delta;
    sums.box_power -= f * n.dot(carried);
    sums.contact_power += material.contact_viscosity * delta_rate * delta_rate;
    sums.overlap += delta;
    sums.max_force = std::max(sums.max_force, std::abs(f));
  }
  return sums;
}

}  // namespace grainlaw::dem
