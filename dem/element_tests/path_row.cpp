#include "dem/element_tests/path_row.hpp"

#include <cmath>

namespace grainlaw::dem {

void fill_path(Observation& row, const StraightSegment& segment, int index, double e, double sheared_before) {
  row.segment = index;
  set_strain(row, segment.strain(e));
  row.shear_path = sheared_before + segment.eps_dev_rate() * e;
  // after a reversal to the start only rounding is left: it has no direction
  if (row.eps_dev > 1e-12 * (row.shear_path + std::abs(row.eps_vol))) {
    row.shape_strain = shape_factor(row.strain.tensor);
    row.lode_strain = lode_angle(row.strain.tensor);
  }
}

double shear_length(const StraightSegment& segment) { return segment.eps_dev_rate() * segment.length; }

}  // namespace grainlaw::dem
