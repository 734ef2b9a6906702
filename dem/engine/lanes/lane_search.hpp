#pragma once
// The search for neighbours on vectors: who is near at all, and who of a list is near now. In internal units
// (dem/engine/lanes/lanes.hpp).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dem/engine/lanes/lanes.hpp"

namespace grainlaw::dem {

/// How near_skin of each sphere is chosen.
struct NearSkins {
  double duration = 0;         ///< for which it would last at the sphere's speed
  double since = 0;            ///< since the near ones were picked: the speed is also the mean one of that time; 0: not known
  double memory = 0;           ///< share of the skin that it had which it keeps at least
  double least = 0, most = 0;
  double listed = 0;           ///< beyond that, less what a sphere has moved since, the list may lack pairs
};

/// Sets near_skin, also in the rows. Returns the largest sum of a near_skin and what its sphere has moved since the list was made.
double choose_near_skins(Lanes<float>& lanes, const std::array<double, 3>& edge, const NearSkins& skins, std::size_t begin, std::size_t end);
double choose_near_skins(Lanes<double>& lanes, const std::array<double, 3>& edge, const NearSkins& skins, std::size_t begin, std::size_t end);

/// Picks from the list, at the present positions, all pairs nearer than their radii and near_skins; the rows must be current.
/// Everything in internal units.
void pick_near(Lanes<float>& lanes, const std::array<double, 3>& edge, std::size_t begin, std::size_t end);
void pick_near(Lanes<double>& lanes, const std::array<double, 3>& edge, std::size_t begin, std::size_t end);

/// A candidate's view of all spheres for the search of neighbours, in spatial order.
struct SearchField {
  const std::int32_t *x = nullptr, *y = nullptr, *z = nullptr;  ///< steps of 2^-32 of the cell's edges
  const float* reach = nullptr;                                 ///< radius and half the skin
  std::array<float, 3> edge{};                                  ///< of the cell over 2^32
};

/// Spheres [begin, end) in spatial order.
struct SearchRange {
  std::uint32_t begin = 0, end = 0;
};

struct FoundNear {
  std::size_t listed = 0;  ///< nearer than the sum of the reaches
  std::size_t near = 0;    ///< of them those nearer by `narrower`
};

/// Writes to `found` (room for 16 more than all) the spheres of the ranges that are nearer to sphere i than the sum of
/// their reaches, i itself left out.
FoundNear find_near(const SearchField& field, std::size_t i, std::span<const SearchRange> ranges, float narrower,
                    std::uint32_t* found);

/// Values in the order of their keys, which are distinct: the place of each is the number of smaller keys. For few, since the
/// cost grows as their square. `key` has room for 16 more, which are overwritten.
void order_by_key(std::int32_t* key, const std::uint32_t* value, std::size_t count, std::uint32_t* ordered);

}  // namespace grainlaw::dem
