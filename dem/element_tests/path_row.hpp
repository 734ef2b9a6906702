#pragma once
// What an observation takes from the path instead of the packing.

#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

/// Fills segment, strain, eps_vol, eps_dev, shear_path, shape and Lode angle of strain at e of the segment with this index;
/// `sheared_before`: shear path of the segments before it [-].
void fill_path(Observation& row, const StraightSegment& segment, int index, double e, double sheared_before);

/// Deviatoric strain along the whole segment [-].
double shear_length(const StraightSegment& segment);

}  // namespace grainlaw::dem
