#pragma once
// The law's curves over volume fraction, ours beside the published ones (Tables 2 and 3 of the paper through Eqs. 11,
// 12, 14, 20). Curves are compared, not parameters: those of Eqs. (11) and (12) scatter hugely at equal curves.

#include <vector>

#include "model/calibrated_law.hpp"

namespace grainlaw {

struct DensityCurve {
  const char* quantity;             ///< name in files, e.g. "C_star", "stress_ratio_max"
  const char* symbol;               ///< the paper's, in the report's notation: {..} italic, _{..} subscript
  std::vector<const char*> groups;  ///< parameters that it reads: names in parameter_table() up to their dot
  double (*of)(const LawParameters<double>&, double nu);  ///< value at volume fraction nu [-]
};

/// C_star, rattler_fraction, P_star of ISO unloading and (steady_...) of steady D2; stress_ratio_max, stress_rate,
/// fabric_max, fabric_rate.
const std::vector<DensityCurve>& density_curves();

/// Whether every parameter that the curve reads has a value.
bool has_values(const CalibratedLaw& law, const DensityCurve& curve);

/// Standard error of the curve at volume fraction `nu` by the delta method, sqrt(g^T V g), g its gradient to the parameters
/// that it reads. V has the terms between stages, too: P* by Eq. (14) reads C* and phi_r, of the same packings. NaN when a
/// parameter that the curve reads has no error.
double standard_error(const CalibratedLaw& law, const DensityCurve& curve, double nu);

/// Its degrees of freedom: those of the parameters, weighted by their shares in the variance (docs/theory/bands.md, Weighted
/// degrees of freedom). NaN where there is no error.
double degrees_of_freedom(const CalibratedLaw& law, const DensityCurve& curve, double nu);

struct CurvePoint {
  const DensityCurve* curve = nullptr;
  double nu = 0;         ///< volume fraction [-]
  double ours = 0;       ///< from the given parameters [-]
  double published = 0;  ///< likewise from the published ones [-]
};

/// Every curve at every multiple of 1/`per_unit` within [nu_min, nu_max] (to rounding), curve by curve.
std::vector<CurvePoint> curve_points(const LawParameters<double>& ours, const LawParameters<double>& published,
                                     double nu_min, double nu_max, int per_unit = 50);

}  // namespace grainlaw
