#pragma once
// Eqs. (11), (12), (13), (14) and F_v = g3 nu C over volume fraction, each a stage of its own.
//   Eq. (11): C* rows, unweighted, C0 = 6 fixed
//   Eq. (12): phi_r rows, unweighted, nu_c that of Eq. (11)
//   Eq. (14): as Eq. (15) like the paper does, P* nu_c/(nu C) against p0 x (1 - gamma_p x), x = ln(nu/nu_c), with the
//             measured C = (1 - phi_r) C*: the pressure's parameters then carry no misfit of Eqs. (11) and (12). Both sides are
//             over the nu_c of P*, times the start's: were the data multiplied by what is fitted, a smaller nu_c would shrink all
//             misfits and win by it. Unweighted, so that no row near jamming outweighs the branch.
//   Eq. (13): <delta>_c/<r> = D ln(nu/nu_c), nu_c that of Eq. (14)
// nu_c ends at the latest kNearestJamming below the lowest density of the data, where Eq. (11) has its infinite slope.

#include "fit/data/density_series.hpp"
#include "fit/stages/stage.hpp"

namespace grainlaw::fit {

/// One of the two state laws of the calibrated law.
struct StateLawName {
  const char* prefix;  ///< of its names in parameter_table()
  StateLaw<double> LawParameters<double>::*law;
};
inline constexpr StateLawName kUnloadingLaw{"", &LawParameters<double>::isotropic};
inline constexpr StateLawName kSteadyLaw{"steady_", &LawParameters<double>::steady};

/// Stages "coordination", "rattlers", "pressure" with the prefix, in this order. With fewer than three densities (two for the
/// rattlers) parameters are not identified.
std::vector<StageDefinition> state_law_stages(const StateLawName& of, const std::vector<DensitySeries>& series,
                                              const std::string& window);
/// Stage "pressure" of tests that count no contacts: C in Eqs. (14), (15) is that of `law`, with the free nu_c for its own.
StageDefinition pressure_of_assumed_contacts(const StateLawName& of, const std::vector<DensitySeries>& series,
                                             const std::string& window);
/// They without any data.
std::vector<StageDefinition> left_out_state_law(const StateLawName& of, const std::string& remedy);

/// Stage "overlap": D of Eq. (13) with the final nu_c of the pressure: after the last stage that moves it. Left out when the data
/// set does not contain overlaps.
StageDefinition overlap_stage(const std::vector<DensitySeries>& series, const std::string& window);

/// Stage "fabric_trace": g3. Left out when the tests tell no fabric or count no contacts.
StageDefinition fabric_trace_stage(const std::vector<DensitySeries>& series, const std::string& window);

}  // namespace grainlaw::fit
