#pragma once
// Whether the rows of a test can be what their columns say. Most columns follow from others; where they do not, columns
// were swapped or units changed on the way.
//   P* = 2<r>/k tr(sigma)/3,  nu = nu_0 exp(-eps_vol),  eps_vol = tr eps,  F_v = tr F,  C = (1 - phi_r) C*,
//   eps_dev, s_dev, F_dev: norms of the tensors;  s_par, F_par: their parts along the test's first shear
//   strain: on the segment of the path that the row says
// Two relations hold for any packing of soft spheres, within factors that depend on the size distribution:
//   P* = g_p nu C <delta>/(2 pi <r>), g_p = 0.7 ... 1;  F_v = g3 nu C, g3 = 1 ... 1.5

#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

/// Throws InvalidInput naming test, row and column, with the remedy. Columns that are undefined where that is allowed are
/// not judged; strain, nu, stress, P_star and fabric must be finite.
void check_rows(const TestRecord& test);

}  // namespace grainlaw::fit
