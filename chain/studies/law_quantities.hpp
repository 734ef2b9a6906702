#pragma once
// What a calibration says of the law, each with what every packing moved it by: psi_c of the parameters (fit/statistics/covariance.hpp)
// times the slope of the quantity. Costs no further fit, and is the error that bands are drawn of; where a fit is linear in
// its parameters it is that of fits without each packing in turn.

#include <vector>

#include "chain/studies/study_quantity.hpp"
#include "fit/calibrate.hpp"
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

}  // namespace grainlaw::chain
