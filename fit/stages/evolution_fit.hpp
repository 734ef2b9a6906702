#pragma once
// The coupled evolution equations, Eq. (16), on all trajectories at once. Free: p0, gamma_p, nu_c of
// Eq. (14), the twelve numbers of Eq. (20), and a2 (Coupling::energy) or a0 (Coupling::single).

#include "fit/stages/stage.hpp"
#include "fit/stages/trajectory.hpp"

namespace grainlaw::fit {

/// True when a trajectory changes the volume of a state with fabric along its test's shear: only then the coupling of
/// fabric and volumetric strain is in the data.
bool contains_anisotropy(const std::vector<Trajectory>& trajectories);
inline constexpr const char* kChangeTheVolume =  ///< the remedy
    "add a test that shears and then changes the volume, e.g. D2 to eps_dev = 0.15 and then ISO to nu + 0.03 and back";

/// What the fits of Eq. (16) make small, on all trajectories at once, row by row at the observed strains:
///   P*  relative to the datum, on ISO unloading only. In shear P is shown but has no weight: Eq. (16) has no dilatancy
///       (+33 % at nu = .68), and a fit of it would turn a2 (through A1) and p0 into something else.
///   s   sigma'/P with the model's own P in the model and the measured one in the data, so that a wrong level of P cancels
///   F   fabric
/// The deviators along the directions of the test's own segments (s_par, F_par; one component on co-axial paths): what
/// stands across them is the noise of a finite packing, and no parameter moves it.
/// Weights: shear_window() of data/shear_rows.hpp, in units of the scales in CalibrationOptions; each test and quantity counts
/// the same. One block per trajectory. Of the parameters `free`, at most 16 names of parameter_table(); the others have the values of `law`.
std::vector<ResidualBlock> evolution_blocks(const std::vector<Trajectory>& trajectories,
                                            const LawParameters<double>& law, const std::vector<std::string>& free,
                                            const CalibrationOptions& options);

/// Stage "evolution". Claims are withdrawn where the data cannot carry them (evolution_checks.hpp). Laws of Eq. (20) named in
/// `held`, of which no shear test shows anything, stay as they are; so does the coupling without any path that identifies it.
StageDefinition evolution_stage(const std::vector<Trajectory>& trajectories, const std::vector<std::string>& held,
                                const CalibrationOptions& options);

/// a1 = mean of A1/(B F_N) over steady shear by the identity A1 = (2/3)(A2 - sigma_dev): tied to a2, Coupling::energy.
/// Its error comes from a2's and from the scatter of the ratio over packings.
struct TiedCoupling {
  Estimate a1;
  Eigen::RowVectorXd influence;  ///< of the packings; as wide as that of a2, zero without an error
};
TiedCoupling tied_a1(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law, const Estimate& a2,
                     const Eigen::RowVectorXd& influence_on_a2, const CalibrationOptions& options);

}  // namespace grainlaw::fit
