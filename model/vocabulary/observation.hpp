#pragma once
// What is seen of a packing at one instant: one row of a test's series.
// Undefined quantities are NaN here, empty in CSV, null in JSON. Definitions: Eqs. (3)-(10) and section 4.1 of the paper.
// Signs: strain tension positive, stress compression positive; shape factors and Lode angles are of tension-positive
// tensors, stress and fabric negated. * means made dimensionless with 2<r>/k. N is the test's first shear direction: what is
// measured along it is undefined where the test has none.

#include <limits>

#include "model/vocabulary/fields.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

/// Meaning, symbol and unit of each member: the table below, where a new one gets a line, too.
struct Observation {
  static constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

  double time = undefined;
  int segment = 0;
  Strain strain;
  double eps_vol = undefined;
  double eps_dev = undefined;
  double shear_path = undefined;
  double nu = undefined;
  Stress stress;
  Stress stress_kinetic;
  double P_star = undefined;
  double s_dev = undefined;
  double s_par = undefined;
  Fabric fabric;
  double F_v = undefined;
  double F_dev = undefined;
  double F_par = undefined;
  double shape_strain = undefined;
  double shape_stress = undefined;
  double shape_fabric = undefined;
  double lode_strain = undefined;
  double lode_stress = undefined;
  double lode_fabric = undefined;
  double C_r = undefined;
  double C = undefined;
  double C_star = undefined;
  double rattler_fraction = undefined;
  double mean_overlap = undefined;
  double E_kin = undefined;
  double E_pot = undefined;
  double W_box = undefined;
  double D_contact = undefined;
  double D_background = undefined;
  double energy_residual = undefined;
  double inertial_number = undefined;
};

/// Where a row lies on its path: the fields that observations, probes and predictions have in common. `rule` holds for those
/// that follow from others.
template <class Row>
constexpr auto place_fields(Rule rule) {
  return std::tuple{
      Field{&Row::segment, "segment", "", "", "index of the path's segment, from 0", rule},
      Field{&Row::strain, "strain", "", "eps", "logarithmic strain since the start of the path, tension positive",
            Rule::needed_number},
      Field{&Row::eps_vol, "eps_vol", "", "eps_vol", "volumetric strain ln(V/V0), negative in compression", rule},
      Field{&Row::eps_dev, "eps_dev", "", "eps_dev", "deviatoric strain, Eq. (4)", rule},
      Field{&Row::shear_path, "shear_path", "", "", "integral of |d eps_dev|, grows on reversal too", rule},
      Field{&Row::nu, "nu", "", "nu", "volume fraction", Rule::needed_number}};
}

/// The columns of a series, in the order of writing.
constexpr auto fields_of(std::type_identity<Observation>) {
  using O = Observation;
  return std::tuple_cat(
      std::tuple{Field{&O::time, "time", "s", "t", "time since the start of the test"}}, place_fields<O>(Rule::plain),
      std::tuple{
          Field{&O::stress, "stress", "Pa", "sigma",
                "contact stress, Eq. (5), viscous forces included, compression positive", Rule::needed_number},
          Field{&O::stress_kinetic, "stress_kinetic", "Pa", "sigma_kin",
                "kinetic stress of the fluctuation velocities"},
          Field{&O::P_star, "P_star", "", "P*", "pressure times 2<r>/k, Eq. (7)"},
          Field{&O::s_dev, "s_dev", "", "s_dev", "stress ratio sigma_dev/P, Eq. (8), a norm"},
          Field{&O::s_par, "s_par", "", "s_par", "signed stress ratio along the test's first shear direction"},
          Field{&O::fabric, "fabric", "", "F", "fabric tensor, Eq. (9)"},
          Field{&O::F_v, "F_v", "", "F_v", "trace of the fabric"},
          Field{&O::F_dev, "F_dev", "", "F_dev", "deviatoric fabric, Eq. (10), a norm, not divided by the trace"},
          Field{&O::F_par, "F_par", "", "F_par", "signed deviatoric fabric along the test's first shear direction"},
          Field{&O::shape_strain, "shape_strain", "", "Lambda_eps", "shape factor of the strain (Table 1)"},
          Field{&O::shape_stress, "shape_stress", "", "Lambda_sigma", "shape factor of the stress"},
          Field{&O::shape_fabric, "shape_fabric", "", "Lambda_F", "shape factor of the fabric"},
          Field{&O::lode_strain, "lode_strain", "deg", "theta_eps", "Lode angle of the strain (Table 1)"},
          Field{&O::lode_stress, "lode_stress", "deg", "theta_sigma", "Lode angle of the stress"},
          Field{&O::lode_fabric, "lode_fabric", "deg", "theta_F", "Lode angle of the fabric"},
          Field{&O::C_r, "C_r", "", "C^r", "simple coordination number M/N"},
          Field{&O::C, "C", "", "C", "modified coordination number M4/N"},
          Field{&O::C_star, "C_star", "", "C*", "corrected coordination number M4/N4"},
          Field{&O::rattler_fraction, "rattler_fraction", "", "phi_r",
                "fraction of spheres with fewer than 4 contacts"},
          Field{&O::mean_overlap, "mean_overlap", "", "<Delta>_c",
                "mean overlap of contacts over the mean radius, Eq. (13)"},
          Field{&O::E_kin, "E_kin", "J", "E_kin", "kinetic energy of the fluctuation velocities"},
          Field{&O::E_pot, "E_pot", "J", "E_pot", "elastic energy of the contacts"},
          Field{&O::W_box, "W_box", "J", "W", "work of the box since the start of the test"},
          Field{&O::D_contact, "D_contact", "J", "D_c", "energy dissipated by contact viscosity since the start"},
          Field{&O::D_background, "D_background", "J", "D_b", "energy dissipated by background drag since the start"},
          Field{&O::energy_residual, "energy_residual", "", "", "(W - dE_pot - dE_kin - D)/(|W| + E_kin(0) + D)"},
          Field{&O::inertial_number, "inertial_number", "", "I", "rate times 2<r> sqrt(rho/P)"}});
}
static_assert(tells_every_member<Observation>());

/// Strain of a row and what follows from it alone: eps_vol = tr eps, eps_dev by Eq. (4).
template <class Row>
void set_strain(Row& row, const Strain& strain) {
  row.strain = strain;
  row.eps_vol = strain.tensor.trace();
  row.eps_dev = deviatoric_norm(strain.tensor);
}

/// Stress ratios and deviatoric fabric of a row at pressure P with the deviators sigma and F (sigma in the unit of P):
///   s_dev = |sigma|/P, s_par = <sigma,N>/P (both NaN unless P > 0),   F_dev = |F|, F_par = <F,N>
/// with the unit vector N; s_par and F_par are NaN where N = 0.
template <class Row>
void set_ratios(Row& row, double P, const Deviator<double>& sigma, const Deviator<double>& F,
                const Deviator<double>& N) {
  const bool jammed = P > 0, sheared = N.squaredNorm() > 0;
  row.s_dev = jammed ? sigma.norm() / P : Observation::undefined;
  row.s_par = jammed && sheared ? sigma.dot(N) / P : Observation::undefined;
  row.F_dev = F.norm();
  row.F_par = sheared ? F.dot(N) : Observation::undefined;
}

/// What follows from the other columns of `row` alone: s_dev, s_par, F_v, F_dev, F_par from stress and fabric. Returns the
/// pressure P = tr(sigma)/3 [Pa].
inline double set_following(Observation& row, const Deviator<double>& N) {
  const double P = row.stress.tensor.trace() / 3;
  row.F_v = row.fabric.tensor.trace();
  set_ratios(row, P, deviator<double>(row.stress.tensor), deviator<double>(row.fabric.tensor), N);
  return P;
}

}  // namespace grainlaw
