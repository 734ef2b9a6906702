#pragma once
// Spheres arranged for vector arithmetic: sixteen to a group, one lane each, whatever the width of the machine's
// vectors, so that sums have one order everywhere. Positions are fractions of the cell in fixed point: the wrap-around
// of an integer difference is the nearest image, and a deforming cell costs nothing. What other spheres read of a
// sphere lies together in one row. Lengths, times and masses are in powers of two of SI (Units), so that conversion is
// exact.
//   mixed precision: 32-bit positions, float forces;  full precision: 52-bit positions, double forces
// Only for rectangular cells in which a sphere meets at most one image of another.

#include <boost/align/aligned_allocator.hpp>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace grainlaw::dem {

inline constexpr std::size_t kLanes = 16;

template <class Real>
using FixedPoint = std::conditional_t<std::is_same_v<Real, float>, std::int32_t, std::int64_t>;

/// Steps of the fixed point per cell edge.
template <class Real>
inline constexpr double kStepsPerEdge = std::is_same_v<Real, float> ? 0x1p32 : 0x1p64;

/// Positions per cell edge: in 64-bit words the lowest 12 bits stay zero, so that each fraction is a double.
template <class Real>
inline constexpr double kQuantaPerEdge = std::is_same_v<Real, float> ? 0x1p32 : 0x1p52;

/// SI value of one internal unit, each a power of two.
struct Units {
  double length = 1, time = 1, mass = 1;
};

/// What the neighbours of a sphere read; 32 or 64 bytes, so that it lies in one cache line.
template <class Real>
struct alignas(8 * sizeof(Real)) SphereRow {
  FixedPoint<Real> x, y, z;
  Real reach;       ///< radius and near_skin together
  Real vx, vy, vz;  ///< predicted to the end of the step
  Real radius;
};

/// Beginning with a cache line.
template <class Real>
using Rows = std::vector<SphereRow<Real>, boost::alignment::aligned_allocator<SphereRow<Real>, 64>>;

/// Sixteen spheres: what each step reads beside their rows. Unused lanes have inverse mass 0.
template <class Real>
struct alignas(64) SphereGroup {
  FixedPoint<Real> near_x[kLanes], near_y[kLanes], near_z[kLanes];  ///< when the near were picked from it
  Real vx[kLanes], vy[kLanes], vz[kLanes];
  Real inverse_mass[kLanes];
  Real near_skin[kLanes];  ///< how far it may move before the near ones are picked again, in a cell that keeps its shape
};

/// The same sixteen where they are; left behind while steps are taken two halves at once (force_kick_drift()), which reads and writes
/// rows instead. Unused lanes have a radius so negative that they touch nobody.
template <class Real>
struct alignas(64) PlacedGroup {
  FixedPoint<Real> x[kLanes], y[kLanes], z[kLanes];
  Real ax[kLanes], ay[kLanes], az[kLanes];  ///< or predicted velocities, Lanes::predicted
  Real radius[kLanes];
};

/// The same sixteen when the list was made; most steps need not read them.
template <class Real>
struct alignas(64) ListedGroup {
  FixedPoint<Real> x[kLanes], y[kLanes], z[kLanes];
  std::uint32_t sphere[kLanes];  ///< index in the State
};

inline constexpr float kNobodysRadius = -0x1p100F;

// Neighbours are listed twice. The list of all within a wide skin lasts for long; of it those within narrow skins are
// picked again and again, which costs two to three force passes, and only they are visited for forces. Each sphere has a narrow
// skin of its own, by its speed: a few in a thousand move several times as far as the others. Neighbours are in the order of the
// State in both lists, so no force depends on when either was made, nor on the skins.

/// The k-th neighbours of the sixteen spheres of a group: where their rows begin [bytes].
struct alignas(64) Tier {
  std::uint32_t row[kLanes];
};

template <class Real>
struct Lanes {
  std::size_t spheres = 0;
  std::vector<SphereGroup<Real>> group;
  std::vector<PlacedGroup<Real>> placed;
  std::vector<ListedGroup<Real>> listed;
  Rows<Real> row;                          ///< in the order of lanes; the last one is nobody's, for unused places
  Rows<Real> next_row;                     ///< those of the next step while they are written
  std::vector<std::size_t> first_tier;     ///< of each group, and the end
  std::vector<Tier> tier;                  ///< the list
  std::vector<Tier> near_tier;             ///< the near ones, of the groups that were picked together without gaps
  std::vector<std::size_t> near_first;     ///< of each group
  std::vector<std::uint32_t> near_count;   ///< tiers of them in each group
  std::size_t frontier = 0;                ///< groups from one to the farthest ahead whose rows it reads, roughly
  bool beyond_caches = false;              ///< more spheres than a core's caches hold from step to step
  bool rows_ahead = false;                 ///< placed groups are behind their rows; take_rows() brings them up
  bool predicted = false;                  ///< take_rows() has: they have the rows' velocities in place of accelerations
  Units unit;
};

}  // namespace grainlaw::dem
