#pragma once
// A frame of somebody else's spheres with what its columns mean, in SI: a packing, and the contacts that are listed with it.

#include <cstddef>
#include <vector>

#include "dem/engine/packing.hpp"
#include "dem/foreign/foreign_frame.hpp"
#include "dem/foreign/given_contacts.hpp"
#include "dem/foreign/particle_request.hpp"

namespace grainlaw::dem {

struct Frame {
  ForeignFrame source, contacts_source;  ///< without their rows; for messages
  double time = 0;                       ///< [s]; NaN: not told
  Packing packing;                       ///< in the order of the ids, wrapped into the cell; masses 0 without a density
  bool has_velocities = false;           ///< else they are zero
  std::vector<ListedContact> contacts;   ///< of a request with contacts
};

/// The frames of a request, one after the other. Throws InvalidInput naming file, line, column and remedy.
class Frames {
 public:
  explicit Frames(const ParticleRequest& request);
  bool next(Frame& frame);

 private:
  Eigen::Matrix3d cell_of(const ForeignFrame& frame) const;
  double time_of(const ForeignFrame& frame) const;
  void take_spheres(const ForeignFrame& from, Frame& to) const;
  void take_contacts(const ForeignFrame& from, Frame& to) const;

  const ParticleRequest& request_;
  FrameFiles spheres_, contacts_;
  std::size_t count_ = 0;
};

}  // namespace grainlaw::dem
