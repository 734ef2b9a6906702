#pragma once
// Eqs. (11), (12), (13), (14) and F_v = g3 nu C over volume fraction, each a stage of its own.
//   Eq. (11): C* rows, unweighted, C0 = 6 fixed
//   Eq. (12): phi_r rows, unweighted, nu_c that of Eq. (11)
//   Eq. (14): as Eq. (15) like the paper does, P* nu_c/(nu C) against p0 x (1 - gamma_p x), x = ln(nu/nu_c), with the
//             measured C = (1 - phi_r) C*: the pressure's parameters then carry no misfit of Eqs. (11) and (12). nu_c
//             stands on both sides. Unweighted, so that no row near jamming outweighs the branch.
//   Eq. (13): <delta>_c/<r> = D ln(nu/nu_c), nu_c that of Eq. (14)
// nu_c ends at the latest 1e-4 below the lowest density of the data, where Eq. (11) has its infinite slope.

#include "fit/stages/density_series.hpp"
#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

/// The least squares problem of one stage, as it is solved and as tests differentiate it.
struct DensityProblem {
  std::vector<FreeParameter> parameters;
  std::vector<ResidualBlock> blocks;
};

/// `prefix` is "" (ISO unloading) or "steady_" (steady D2): names are those of parameter_table().
DensityProblem coordination_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                    const Coordination<double>& start);
DensityProblem rattlers_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                const Rattlers<double>& start, double nu_c);
DensityProblem pressure_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                const Pressure<double>& start);

/// Stages "coordination", "rattlers", "pressure" with the prefix, in this order; errors of the second contain that of nu_c. `law` holds the start and takes the result.
/// With fewer than three densities (two for the rattlers) parameters are not identified.
std::vector<StageFit> fit_state_law(const std::string& prefix, const std::vector<DensitySeries>& series,
                                    const std::string& window, StateLaw<double>& law, const CalibrationOptions& options,
                                    const RunControl& control);

/// Stage "overlap": D of Eq. (13), with nu_c of the stage `pressure`. Left out when the data set does not contain overlaps.
StageFit fit_overlap(const std::vector<DensitySeries>& series, const std::string& window, const StageFit& pressure,
                     double start, const CalibrationOptions& options, const RunControl& control);

/// Stage "fabric_trace": g3.
StageFit fit_fabric_trace(const std::vector<DensitySeries>& series, const std::string& window, double start,
                          const CalibrationOptions& options, const RunControl& control);

}  // namespace grainlaw::fit
