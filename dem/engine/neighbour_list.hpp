#pragma once
// Full neighbour list of a periodic, possibly sheared cell: every sphere lists all spheres and images (its own
// included) nearer than r_i + r_j + skin, sorted by (j, image). Each entry knows its image by the integer offset n:
//   x_ij = H (s_i - s_j - n)
// A list is valid as long as no unlisted pair can touch: min(1, sigma_min(H H_ref^-1)) (R + skin) - 2u >= R for
// R = 2 r_max, u the largest distance |H (s - s_ref)| that a sphere moved against the cell since the rebuild.

#include <cstdint>
#include <vector>

#include "dem/engine/packing.hpp"
#include "dem/engine/thread_team.hpp"

namespace grainlaw::dem {

struct NeighbourList {
  std::vector<std::size_t> first;    ///< N+1 offsets into the arrays below
  std::vector<std::uint32_t> j;      ///< neighbour
  std::vector<std::uint32_t> image;  ///< index into `offset`
  std::vector<Eigen::Vector3d> offset;  ///< integer image offsets n that occur
  double skin = 0;                   ///< [m]
  double r_max = 0;                  ///< largest radius [m]
};

/// Farthest that a file may put a sphere, in cells: beyond, the two are not in one unit.
constexpr double kMaxCellsAway = 1000;

/// Of an offset or normal and its opposite, one: of a sphere that touches its own image, each contact once.
inline bool first_of_opposites(const Eigen::Vector3d& n) {
  return n.z() != 0 ? n.z() > 0 : n.y() != 0 ? n.y() > 0 : n.x() > 0;
}

/// Wraps the fractions of the packing into [0, 1].
void wrap(Packing& packing);

/// Lists the packing as it is (fractions need not be wrapped). Throws InvalidInput from 2^32 spheres on.
NeighbourList build_list(const Packing& packing, double skin, ThreadTeam& team);

/// Distance u [m] that a sphere may move against the cell before the list becomes invalid, once the cell has gone from
/// `ref_H` to `H`; negative when the deformation alone invalidates it.
double allowed_displacement(const NeighbourList& list, const Eigen::Matrix3d& ref_H, const Eigen::Matrix3d& H);

}  // namespace grainlaw::dem
