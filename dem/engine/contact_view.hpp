#pragma once
// A packing's contacts for sums over them: whatever the engine, in double precision and in the order of the packing.

#include <memory>
#include <vector>

#include "dem/engine/contacts.hpp"
#include "dem/engine/stepping.hpp"

namespace grainlaw::dem {

/// Position x = H s [m] with the radius.
Row place_with_radius(const Packing& packing, std::size_t i);

/// H n [m] of each image of the list.
std::vector<Eigen::Vector3d> image_shifts(const Eigen::Matrix3d& H, const NeighbourList& list);

/// What sums over the contacts of a state read; all arguments must outlive it.
ForceField force_field(const State& state, const CellMotion& motion, const NeighbourList& list,
                       const std::vector<Row>& place, const std::vector<Row>& velocity,
                       const std::vector<Eigen::Vector3d>& shift);

/// The contacts of a state for its velocities.
struct ContactView {
  NeighbourList list;
  std::vector<Row> place, velocity;
  std::vector<Eigen::Vector3d> shift;
  ForceField field;  ///< points into the members above and into the state
};

/// The state must outlive the view and stay as it is.
std::unique_ptr<ContactView> view_contacts(const State& state, NeighbourList list, const CellMotion& motion);

}  // namespace grainlaw::dem
