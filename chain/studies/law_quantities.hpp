#pragma once
// What packings say of the laws, each quantity with what every packing moved it by (docs/theory/studies.md, section
// Quantities of a setting):
// - by a calibration: psi_c of the parameters (fit/statistics/covariance.hpp) times the slope of the quantity. That costs no
//   further fit and is the error that bands are drawn of; where a fit is linear in its parameters it is that of fits without
//   each packing in turn;
// - by every packing itself, without a fit to all of them: the mean of those that show it.

#include <vector>

#include "chain/studies/study_quantity.hpp"
#include "fit/calibrate.hpp"
#include "model/files/dataset.hpp"
#include "model/law.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::chain {

/// P_star@nu, C_star@nu (Eqs. 11, 14), s_max@nu, beta_s@nu, F_max@nu, beta_F@nu (Eq. 20) at `densities`, and nu_c (Eq. 14);
/// NaN where a law is not identified. `packings`: number of columns of the influence.
std::vector<StudyQuantity> law_quantities(const fit::Calibration& calibration, const std::vector<double>& densities,
                                          std::size_t packings);

/// P_star, s_par, F_par along `path`, from the law's own start, by `rung`. Throws like predict::predict().
std::vector<StudyQuantity> predicted_quantities(const fit::Calibration& calibration, const Path& path, Rung rung,
                                                std::size_t packings, const RunControl& control);

/// The same numbers at the densities of shear, and nu_c, by the calibration tests of the packings `seeds`, two at least. A
/// quantity that fewer than two show is not shown (a run of a small packing may not show where it saturates). nu_c is not
/// part of an error: it is known far better than what depends on it. Throws InvalidInput like fit::check_and_sort().
std::vector<StudyQuantity> packing_quantities(const Dataset& dataset, const std::vector<std::uint64_t>& seeds);

}  // namespace grainlaw::chain
