#pragma once
// What a plane through a packing shows: the spheres that it cuts, the contacts beside it with their elastic forces, and the
// directions of all contacts as seen in it. With a the angle of a contact's normal in the plane, from the horizontal axis,
// and n_h, n_v its components there, a rose holds in each bin of a
//   count: sum of n_h^2 + n_v^2      force: sum of f (n_h^2 + n_v^2)
// over its mean, so that an isotropic packing gives 1 everywhere, and sum of count cos 2a is that of n_h^2 - n_v^2.

#include <array>
#include <vector>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

/// Of the plane of two cell axes through the middle of the cell; lengths over the mean radius.
struct PackingPicture {
  double width = 0, height = 0;                ///< of what is shown: the cell, or its part up to kPictureSize
  std::vector<std::array<double, 3>> circles;  ///< horizontal, vertical, radius of the cut, images included
  std::vector<std::array<double, 5>>
      chains;                        ///< of contacts within ⟨r⟩/2 of the plane: both centres, force over the mean
  std::vector<double> count, force;  ///< roses over 180 degrees, kRoseBins each
};
GRAINLAW_FIELDS(PackingPicture, width, height, circles, chains, count, force);

inline constexpr double kPictureSize = 40;
inline constexpr int kRoseBins = 18;

/// `horizontal` and `vertical` are different axes 0, 1, 2. An axis beyond the picture's size is shown in part; without
/// contacts the roses are empty.
PackingPicture picture_of(const State& state, int horizontal, int vertical, int threads);

}  // namespace grainlaw::dem
