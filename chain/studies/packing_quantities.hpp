#pragma once
// What each packing by itself says of the law, without a fit to all of them: P_star@nu and C_star@nu (Eqs. 11, 14), s_max@nu,
// beta_s@nu, F_max@nu, beta_F@nu (Eqs. 17, 18), and nu_c (Eq. 14). The value is the mean of the n packings that show it, two at
// least (a run of a small packing may not show where it saturates); packing c moved it by (x_c - mean)/sqrt(n (n - 1)), by nothing if
// it does not show it.

#include "model/files/dataset.hpp"
#include "chain/studies/study_quantity.hpp"

namespace grainlaw::chain {

/// Of the calibration tests of the packings `seeds`, two at least. nu_c is not part of an error: it is known far better than
/// what depends on it. Throws InvalidInput like fit::check_and_sort().
std::vector<StudyQuantity> packing_quantities(const Dataset& dataset, const std::vector<std::uint64_t>& seeds);

}  // namespace grainlaw::chain
