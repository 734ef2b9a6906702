#pragma once
// The coupled evolution equations, Eq. (16), on all trajectories at once (evolution_problem.hpp). Free: p0, gamma_p, nu_c of
// Eq. (14), the twelve numbers of Eq. (20), and a2 (Coupling::energy) or a0 (Coupling::single).

#include "fit/stages/evolution_problem.hpp"
#include "fit/statistics/inherited_error.hpp"
#include "fit/statistics/stage_fit.hpp"
#include "fit/stages/trajectory.hpp"

namespace grainlaw::fit {

/// Names of the free parameters without those of the laws of Eq. (20), or the coupling's, named in `held`.
std::vector<std::string> evolution_parameters(Coupling coupling, const std::vector<std::string>& held = {});

/// True when a trajectory changes the volume of a state with fabric along its test's shear: only then the coupling of
/// fabric and volumetric strain is in the data.
bool contains_anisotropy(const std::vector<Trajectory>& trajectories);

/// Stage "evolution"; `law` holds the start and takes the result. Claims are withdrawn where the data cannot carry them:
/// saturation shown at fewer than three densities, a rate that acts on nothing, no path that identifies the coupling.
/// Laws of which no shear test shows anything (`held`) stay as they are. Errors contain those of `found` for Eqs. (11), (12).
StageFit fit_evolution(const std::vector<Trajectory>& trajectories, LawParameters<double>& law,
                       std::vector<std::string> held, const CalibrationOptions& options, const RunControl& control,
                       const FoundErrors& found = {});

/// a1 = mean of A1/(B F_N) over steady shear by the identity A1 = (2/3)(A2 - sigma_dev): tied to a2, Coupling::energy.
/// Its error comes from a2's and from the scatter of the ratio over packings.
struct TiedCoupling {
  Estimate a1;
  Eigen::RowVectorXd influence;  ///< of the packings; as wide as that of a2, zero without an error
};
TiedCoupling tied_a1(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law, const Estimate& a2,
                     const Eigen::RowVectorXd& influence_on_a2, const CalibrationOptions& options);

}  // namespace grainlaw::fit
