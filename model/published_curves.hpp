#pragma once
// Our density curves beside the published ones (Tables 2 and 3 of the paper through Eqs. 11, 12, 14, 20). Curves are
// compared, not parameters: the parameters of Eqs. (11) and (12) scatter hugely at equal curves.

#include <string>
#include <vector>

#include "model/parameters.hpp"

namespace grainlaw {

struct CurvePoint {
  std::string quantity;  ///< "C_star", "rattler_fraction", "P_star", "steady_...", "stress_ratio_max", "stress_rate", ...
  double nu = 0;         ///< volume fraction [-]
  double ours = 0;       ///< from the calibrated parameters [-]
  double published = 0;  ///< from the published parameters [-]
};

/// Every curve at every density. Below a curve's own jamming density (P* = 0 there) the point is left out.
std::vector<CurvePoint> published_curves(const LawParameters<double>& ours, const std::vector<double>& densities);

}  // namespace grainlaw
