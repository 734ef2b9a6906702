#pragma once
// Standard error of a curve over density, from the covariance of its parameters by the delta method: g^T V g, g the
// gradient of the curve. V has the terms between stages, too: P* by Eq. (14) reads C* and phi_r, of the same packings.

#include "model/calibrated_law.hpp"
#include "model/density_curves.hpp"

namespace grainlaw::fit {

/// At volume fraction `nu`; NaN when a parameter that the curve reads has no error.
double standard_error(const CalibratedLaw& law, const DensityCurve& curve, double nu);

}  // namespace grainlaw::fit
