#pragma once
// The plain O(N^2) reference that the engine is judged by: all pairs, all images within reach, any upper-triangular
// cell. Simple on purpose and written without the engine's parts: no list, no threads, each contact visited once.
//   x_ij = H (s_i - s_j - n),  delta = r_i + r_j - |x_ij| > 0,  n_ij = x_ij/|x_ij|,  l = x_ij
//   f = (k delta + gamma d(delta)/dt) n_ij on i and -f on j,  d(delta)/dt = -u . n_ij
//   u = v_i - v_j + L x_ij  (homogeneous)   or   v_i - v_j + L H (floor s_i - floor s_j - n)  (wall-driven)
//   virial = sum_c f l,  F = (1/V) sum_p V_p sum_{c in p} n n
//   box power = -sum_c f n . (u - v_i + v_j),  contact dissipation = sum_c gamma (d(delta)/dt)^2
//   E_pot = sum_c k delta^2/2
// Equations (1), (5), (9). SI units, compression positive. Cost: seconds from some thousand spheres on.

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dem/engine/stepping.hpp"

namespace grainlaw::dem {

namespace reference {

inline Eigen::Vector3d fraction_of(const Packing& p, std::size_t i) { return {p.sx[i], p.sy[i], p.sz[i]}; }
inline Eigen::Vector3d velocity_of(const Packing& p, std::size_t i) { return {p.vx[i], p.vy[i], p.vz[i]}; }

/// Distance between opposite faces of the cell, for each pair of faces [m].
inline Eigen::Vector3d face_distances(const Eigen::Matrix3d& H) {
  const double volume = std::abs(H.determinant());
  return {volume / H.col(1).cross(H.col(2)).norm(), volume / H.col(2).cross(H.col(0)).norm(),
          volume / H.col(0).cross(H.col(1)).norm()};
}

inline bool first_of_opposites(const Eigen::Vector3i& n) {
  if (n.z() != 0) return n.z() > 0;
  if (n.y() != 0) return n.y() > 0;
  return n.x() > 0;
}

}  // namespace reference

struct ReferencePair {
  std::size_t i = 0, j = 0;  ///< i <= j; for i = j the image and its opposite are one pair, given once
  Eigen::Vector3i image = Eigen::Vector3i::Zero();  ///< n
  Eigen::Vector3d x_ij = Eigen::Vector3d::Zero();   ///< [m]
};

/// Every pair with |x_ij| < r_i + r_j + reach once, fractions wrapped or not. `reach` >= 0 [m].
inline std::vector<ReferencePair> reference_pairs(const Packing& packing, double reach) {
  std::vector<ReferencePair> pairs;
  const Eigen::Vector3d face = reference::face_distances(packing.H);
  for (std::size_t i = 0; i < packing.size(); ++i) {
    for (std::size_t j = i; j < packing.size(); ++j) {
      const double limit = packing.radius[i] + packing.radius[j] + reach;
      const Eigen::Vector3d ds = reference::fraction_of(packing, i) - reference::fraction_of(packing, j);
      // |x_ij| < limit needs |ds - n| < limit/face along each axis; one more image on each side guards the rounding.
      const Eigen::Vector3i low = (ds - limit * face.cwiseInverse()).array().floor().cast<int>() - 1;
      const Eigen::Vector3i high = (ds + limit * face.cwiseInverse()).array().ceil().cast<int>() + 1;
      for (int nx = low.x(); nx <= high.x(); ++nx) {
        for (int ny = low.y(); ny <= high.y(); ++ny) {
          for (int nz = low.z(); nz <= high.z(); ++nz) {
            const Eigen::Vector3i n(nx, ny, nz);
            if (i == j && !reference::first_of_opposites(n)) continue;
            const Eigen::Vector3d x = packing.H * (ds - n.cast<double>());
            if (x.norm() < limit) pairs.push_back({i, j, n, x});
          }
        }
      }
    }
  }
  return pairs;
}

struct ReferenceSums {
  std::vector<Eigen::Vector3d> force;  ///< sum of contact forces on each sphere, drag not included [N]
  std::vector<int> contacts;           ///< contacts of each sphere; a contact with the own image counts twice
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();  ///< V times the contact stress [J]
  Eigen::Matrix3d fabric = Eigen::Matrix3d::Zero();  ///< [-]
  double E_pot = 0;                                  ///< [J]
  double box_power = 0;                              ///< work of the box per time [W]
  double contact_power = 0;                          ///< dissipation of contact viscosity [W]
  double overlap = 0;                                ///< sum over contacts, each once [m]
  double max_force = 0;                              ///< largest |f| of a contact [N]
};

/// Sums over all contacts of the packing as it is; `motion.H` is not used, the packing has its own cell.
inline ReferenceSums reference_sums(const Packing& packing, const Material& material, const CellMotion& motion) {
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
          reference::fraction_of(packing, pair.i).array().floor() -
          reference::fraction_of(packing, pair.j).array().floor() - pair.image.cast<double>().array();
      carried = motion.L * packing.H * cells_apart;
    }
    const Eigen::Vector3d u =
        reference::velocity_of(packing, pair.i) - reference::velocity_of(packing, pair.j) + carried;
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
