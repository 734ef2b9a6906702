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

#include "dem/engine/simulation.hpp"

namespace grainlaw::dem {

struct ReferencePair {
  std::size_t i = 0, j = 0;  ///< i <= j; for i = j the image and its opposite are one pair, given once
  Eigen::Vector3i image = Eigen::Vector3i::Zero();  ///< n
  Eigen::Vector3d x_ij = Eigen::Vector3d::Zero();   ///< [m]
};

/// Every pair with |x_ij| < r_i + r_j + reach once, fractions wrapped or not. `reach` >= 0 [m].
std::vector<ReferencePair> reference_pairs(const Packing& packing, double reach);

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
ReferenceSums reference_sums(const Packing& packing, const Material& material, const CellMotion& motion);

}  // namespace grainlaw::dem
