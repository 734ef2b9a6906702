#pragma once
// From frames of somebody else's spheres to rows of a series, by the definitions of dem/engine/contact_sums.hpp.
//   stress  from the forces that are given, or from the declared law k delta + gamma d(delta)/dt of dem/engine/contact_law.hpp
//   strain  ln of the stretches H H_0^-1 of the cell since the first frame, which must be along the axes
//   L       of the cell by central differences of the strain in time: for gamma and the inertial number; 0 without times
// A sphere with fewer than 4 contacts counts as a rattler, with friction, too.

#include <optional>
#include <string>
#include <vector>

#include "dem/foreign/particle_request.hpp"
#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::dem {

struct ParticleSeries {
  std::vector<Observation> rows;  ///< one for each frame; what follows from a path (segment, s_par, F_par) is undefined
  std::vector<std::string> places;     ///< of the frames, for messages: "dump: step 1000"
  PackingInfo packing;                 ///< particles, mean radius, stiffness
  std::optional<std::string> sheared;  ///< why the strains are undefined: the cell turns or shears
  std::vector<std::string> notes;      ///< what was found and assumed, for the provenance
};

/// Throws InvalidInput naming file, line, column and remedy; Interrupted.
ParticleSeries read_particles(const ParticleRequest& request, const RunControl& control);

}  // namespace grainlaw::dem
