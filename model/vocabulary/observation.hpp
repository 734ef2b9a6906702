#pragma once
// What is seen of a packing at one instant: one row of a test's series.
// Undefined quantities are NaN here, empty in CSV, null in JSON. Definitions: Eqs. (3)-(10) and section 4.1 of the paper.
// Signs: strain tension positive, stress compression positive. * means made dimensionless with 2<r>/k.

#include <limits>

#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

struct Observation {
  static constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

  double time = undefined;          ///< time since the start of the test [s]
  int segment = 0;                  ///< index of the path's segment that the row belongs to
  Strain strain;                    ///< logarithmic strain since the start of the test [-]
  double eps_vol = undefined;       ///< ln(V/V0) = tr strain, negative in compression [-]
  double eps_dev = undefined;       ///< Eq. (4) of `strain` [-]
  double shear_path = undefined;    ///< integral of |d eps_dev| since the start of the test, grows on reversal too [-]
  double nu = undefined;            ///< volume fraction sum V_p/V [-]
  Stress stress;                    ///< contact part of Eq. (5), viscous forces included [Pa]
  Stress stress_kinetic;            ///< kinetic part of Eq. (5), from fluctuation velocities [Pa]
  double P_star = undefined;        ///< Eq. (7) of `stress` [-]
  double s_dev = undefined;         ///< sigma_dev/P, Eq. (8), a norm [-]
  double s_par = undefined;         ///< <sigma',N>/P, signed, N the test's first shear direction; undefined in ISO [-]
  Fabric fabric;                    ///< Eq. (9) [-]
  double F_v = undefined;           ///< tr F [-]
  double F_dev = undefined;         ///< Eq. (10), not divided by tr F [-]
  double F_par = undefined;         ///< <F',N>, signed [-]
  double shape_strain = undefined;  ///< Lambda of strain, stress (tension positive) and fabric (negated) [-]
  double shape_stress = undefined;
  double shape_fabric = undefined;
  double lode_strain = undefined;  ///< Lode angles, likewise [deg]
  double lode_stress = undefined;
  double lode_fabric = undefined;
  double C_r = undefined;                ///< simple coordination number M/N [-]
  double C = undefined;                  ///< modified coordination number M4/N [-]
  double C_star = undefined;             ///< corrected coordination number M4/N4 [-]
  double rattler_fraction = undefined;   ///< phi_r = (N - N4)/N [-]
  double mean_overlap = undefined;       ///< <delta>_c/<r>, mean over contacts [-]
  double E_kin = undefined;              ///< kinetic energy of fluctuation velocities [J]
  double E_pot = undefined;              ///< elastic energy of contacts [J]
  double W_box = undefined;              ///< work of the box since the start of the test [J]
  double D_contact = undefined;          ///< energy dissipated by contact viscosity since the start of the test [J]
  double D_background = undefined;       ///< energy dissipated by background drag since the start of the test [J]
  double energy_residual = undefined;    ///< (W - dE_pot - dE_kin - D)/(|W| + E_kin(0) + D), see hard case D9 [-]
  double inertial_number = undefined;    ///< I = rate d sqrt(rho/P), rate = max(|eps_vol rate|, eps_dev rate), d = 2<r> [-]
};

}  // namespace grainlaw
