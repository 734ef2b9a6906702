#pragma once
// Moderated variances. From G packings a variance has about G - 1 degrees of freedom: two say next to nothing of it, and
// what they say is by chance far too small or far too large. Many packings of the same kind know how much packings scatter;
// their covariance, carried to the size at hand by 1/(packings x spheres), is a prior with degrees of freedom d0 of its own:
//
//   s^2 <- (d0 s0^2 + d s^2)/(d0 + d),   Student's t with d0 + d degrees of freedom         (Smyth 2004, limma)
//
// and for the whole covariance V <- A V0 A + B V B, A = diag sqrt(d0/(d0 + d)), B = diag sqrt(d/(d0 + d)), whose diagonal is
// that. Source, limits and coverage: docs/theory/fit.md, section Moderated variances.

#include <Eigen/Core>
#include <vector>

#include "model/calibrated_law.hpp"

namespace grainlaw::fit {

/// How many packings a calibration has seen, and of how many spheres.
struct PackingCount {
  int packings = 0;
  double spheres = 0;  ///< of all packings together
};

/// A calibration without moderation and what it rests on.
struct SizedLaw {
  CalibratedLaw law;
  PackingCount size;
};

/// What many packings say of the scatter of a calibration's parameters.
struct VariancePrior {
  PackingCount size;
  Eigen::MatrixXd covariance;          ///< of a fit to them, kParameterCount square; zero where there is no error
  Eigen::VectorXd degrees_of_freedom;  ///< d0 per parameter; NaN where there is no error
};

/// The prior of `many`, d0 from `parts`: calibrations of few packings each, whose variances would scatter about the prior as
/// chi^2 does if it were exact. What they scatter beyond that is psi'(d0/2) in the mean square of the logarithm; at most as
/// many degrees of freedom as `many` has, and at least .1. Parameters of which fewer than eight parts have an error are left out.
VariancePrior variance_prior(const SizedLaw& many, const std::vector<SizedLaw>& parts);

/// What moderate() did.
struct Moderation {
  int parameters = 0;  ///< that were moderated; 0: none
  double ratio = 0;    ///< of our variances to the prior's, geometric mean, chance in d degrees of freedom taken out
  double largest_ratio = 0;  ///< beyond which, or below its inverse, the prior is not used
};

/// Moderates the errors of `law`, a fit to packings of this size. Groups of parameters (up to the dot) of which others have
/// an error than in the prior stay as they are. A prior that does not fit the material, by variances that are all too large
/// or too small (more than fourfold beyond chance), is not used.
Moderation moderate(const VariancePrior& prior, const PackingCount& size, CalibratedLaw& law);

}  // namespace grainlaw::fit
