#pragma once
// What the series of a test cannot say, whoever made it. Most columns of a row follow from others; where they do not,
// columns were swapped, signs turned or units changed on the way. Rows are compared to five parts in ten thousand, since
// files of others carry few digits and such a fault is far off.
//   P* = 2<r>/k tr(sigma)/3,  nu = nu_0 exp(-eps_vol),  eps_vol = tr eps,  F_v = tr F,  C = (1 - phi_r) C*,
//   eps_dev, s_dev, F_dev: norms of the tensors;  s_par, F_par: their parts along the test's first shear
// By definition 0 <= phi_r <= 1, C* >= 4 (spheres with fewer contacts are left out), F has no negative eigenvalue, and
// what was dissipated is not negative.
// Of a packing of soft spheres in a test, beyond that (docs/theory/data.md has the reasons and the margins):
//   tr sigma >= 0;  where P* > 0.003 in slow flow C* >= 6 (isostatic, three rows together);  where P* > 0.001
//   P* = g_p nu C <delta>/(2 pi <r>), g_p = 0.7 ... 1, or without <delta> from C* - 6;  F_v = g3 nu C, g3 = 1 ... 1.63
//   the strain is on the segment of the path that the row says, and nu is the path's at its start
//   int (sigma'/P) : d eps' >= what a packing may give back, from the start to any row (compression positive)
//   after 0.1 of the first shear, stress and fabric point along it
//   without C*: P* < 1, and where the volume changes |dP*/d eps_vol| = 0.01 ... 10, which the stiffness of contacts demands
// Friction takes contacts (C* >= 4) and the relation of pressure to them. Fabric may be absent, but then from all rows.

#include <functional>
#include <string>
#include <vector>

#include "model/vocabulary/test_record.hpp"

namespace grainlaw {

/// Names a row, from 0, and a column in messages.
using RowPlace = std::function<std::string(std::size_t row, const std::string& column)>;

/// Refuses a series whose columns contradict each other or their definitions. Undefined values are not judged. Throws
/// InvalidInput "`where`: row 3, column 'nu': " (counted from 1, as below the header of a file) with the value, what
/// contradicts it and the likely cause.
void check_contradictions(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                          const std::string& where);
void check_contradictions(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                          const RowPlace& place);

/// Refuses likewise also what no packing of soft spheres does on that path, strain, nu, stress and P_star that are not finite,
/// and fabric that is not while it is in other rows.
void check_series(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                  const std::string& where);
void check_series(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                  const RowPlace& place);

}  // namespace grainlaw
