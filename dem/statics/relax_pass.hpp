#pragma once
// The force pass of the minimiser (dem/statics/relax.cpp) on the widest vectors that the machine has: one lane a sphere. Each lane adds its
// contacts in the order of the list, and every operation is rounded as in plain loops: the same bits on any machine.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem/engine/contacts.hpp"
#include "dem/engine/lanes/lanes.hpp"

namespace grainlaw::dem {

/// The k-th near neighbours of the sixteen spheres of a group.
struct alignas(64) NearTier {
  std::uint32_t place[kLanes];  ///< of the neighbour's row [bytes from the first]
  std::uint32_t shift[kLanes];  ///< of the image's row, likewise
};

/// Spheres as the pass sees them. Groups are filled within blocks of kBlockSize spheres, those with most neighbours first.
struct RelaxField {
  std::vector<Row> place;               ///< x, y, z, r [m]; the last one is nobody's, far away
  std::vector<Row> shift;               ///< H n of each image of the list [m]
  std::vector<Row> w;                   ///< of the minimiser; [3] is 1/sqrt(m)
  std::vector<Row> g;                   ///< net force over k sqrt(m); [3] is the square of net force over k [m^2]
  std::vector<std::uint32_t> sphere;    ///< of each lane; place.size() - 1 where there is none
  std::vector<std::size_t> first_tier;  ///< of each group
  std::vector<std::uint32_t> tiers;     ///< of each group
  std::vector<NearTier> tier;
};

/// Sums over contacts, each met twice.
struct OverlapSums {
  double overlap = 0;   ///< [m]
  double overlap2 = 0;  ///< of squares [m^2]
  std::size_t meetings = 0;
};

/// Fills g of the spheres in the groups [begin, end). A sphere that shares its place with another one has a g[3] that is not finite.
OverlapSums contact_forces(RelaxField& field, std::size_t begin, std::size_t end);

}  // namespace grainlaw::dem
