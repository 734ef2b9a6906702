#pragma once
// Contacts that somebody lists with their forces: matched with the geometry of the packing, images included, and summed
// (dem/engine/contact_sums.hpp). A contact is a listed pair whose force does not vanish; each may be listed once or twice
// (once by each of its spheres), all of a frame alike.
//   sigma = (1/V) sum_c f l, symmetrised; f the whole force, tangential part included, l = x_i - x_j of the touching images

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "dem/engine/contact_sums.hpp"

namespace grainlaw::dem {

struct ListedContact {
  std::size_t first = 0, second = 0;  ///< places of the spheres in the packing
  Eigen::Vector3d force;              ///< on the first [N]
  Eigen::Vector3d branch =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< x_first - x_second; NaN: not told [m]
  std::size_t line = 0;                                                     ///< of its file, for messages
};

struct GivenSums {
  ContactSums sums;
  bool listed_twice = false;
  double antisymmetry = 0;  ///< |antisymmetric part| of sum f l over |symmetric part|: moments that do not balance [-]
  double unbalanced = 0;    ///< mean net force on a sphere over the mean force of a contact; 0 at rest [-]
};

/// Throws InvalidInput, without the name of the file, for contacts that cannot be those of the packing: spheres that are
/// apart, overlaps without a contact, doubled or one-sided entries, forces that pull (unless they may, by cohesion) or do not
/// follow the contacts.
GivenSums sum_given(const Packing& packing, const std::vector<ListedContact>& contacts, bool may_pull = false);

}  // namespace grainlaw::dem
