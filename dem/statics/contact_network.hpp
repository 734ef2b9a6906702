#pragma once
// The spheres that carry the load of a packing, every pair of them that touches or nearly does, and their elastic forces.
//   E = sum_c k delta^2/2,   f_i = sum_{c in i} k delta n,   V sigma = sum_c k delta n l   (compression positive)
//   l = x_i - x_j - H n_ij,  d = |l|,  n = l/d,  delta = r_i + r_j - d > 0
// A rattler has fewer than four contacts and carries no load at rest. Here rattlers are taken away until none is left: one
// less may leave a neighbour with three. SI units.

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

/// The spheres of a state that are left without rattlers, at rest, in the order of the state; ids are kept.
State backbone_of(const State& state, int threads);

/// A pair that may touch, by its places in the packing; i <= j.
struct NetworkPair {
  std::uint32_t i = 0, j = 0;
  Eigen::Vector3d image = Eigen::Vector3d::Zero();  ///< n_ij [-]
};

/// Every pair nearer than r_i + r_j + skin [m], once.
std::vector<NetworkPair> pairs_within(const Packing& packing, double skin, int threads);

/// One contact of a configuration.
struct NetworkContact {
  std::uint32_t i = 0, j = 0;
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< from j to i [-]
  double d = 0;                                 ///< |l| [m]
  double delta = 0;                             ///< overlap [m]
};

/// The contacts among `pairs` of spheres at x = H s [m], in the order of the pairs. Throws Error when two touching spheres
/// share one position.
std::vector<NetworkContact> contacts_at(const Packing& packing, const std::vector<NetworkPair>& pairs);

struct NetworkForces {
  Eigen::Matrix3Xd net;           ///< net elastic force on each sphere [N]
  double max_net_force = 0;       ///< [N]
  double mean_contact_force = 0;  ///< [N], 0 without contacts
};

NetworkForces forces_of(const std::vector<NetworkContact>& contacts, std::size_t spheres, double stiffness);

/// Elastic stress, compression positive [Pa].
Eigen::Matrix3d stress_of(const std::vector<NetworkContact>& contacts, double stiffness, double volume);

/// How many contacts of `after` are new (first) and how many of `before` are gone (second). Pairs of the same packing.
std::pair<std::size_t, std::size_t> differing_contacts(const std::vector<NetworkContact>& before,
                                                       const std::vector<NetworkContact>& after);

}  // namespace grainlaw::dem
