#include "model/files/series_columns.hpp"

namespace grainlaw {
namespace {

Columns<Observation> make_observation_columns() {
  using O = Observation;
  Columns<O> c;
  add<&O::time>(c, "time", "s", "t", "time since the start of the test");
  add<&O::segment>(c, "segment", "", "", "index of the path's segment, from 0");
  add_tensor<&O::strain>(c, "strain", "", "eps", "logarithmic strain since the start of the test, tension positive",
                         true);
  add<&O::eps_vol>(c, "eps_vol", "", "eps_vol", "volumetric strain ln(V/V0), negative in compression");
  add<&O::eps_dev>(c, "eps_dev", "", "eps_dev", "deviatoric strain, Eq. (4)");
  add<&O::shear_path>(c, "shear_path", "", "", "integral of |d eps_dev|, grows on reversal too");
  add<&O::nu>(c, "nu", "", "nu", "volume fraction", true);
  add_tensor<&O::stress>(c, "stress", "Pa", "sigma",
                         "contact stress, Eq. (5), viscous forces included, compression positive", true);
  add_tensor<&O::stress_kinetic>(c, "stress_kinetic", "Pa", "sigma_kin",
                                 "kinetic stress of the fluctuation velocities");
  add<&O::P_star>(c, "P_star", "", "P*", "pressure times 2<r>/k, Eq. (7)");
  add<&O::s_dev>(c, "s_dev", "", "s_dev", "stress ratio sigma_dev/P, Eq. (8), a norm");
  add<&O::s_par>(c, "s_par", "", "s_par", "signed stress ratio along the test's first shear direction");
  add_tensor<&O::fabric>(c, "fabric", "", "F", "fabric tensor, Eq. (9)", true);
  add<&O::F_v>(c, "F_v", "", "F_v", "trace of the fabric");
  add<&O::F_dev>(c, "F_dev", "", "F_dev", "deviatoric fabric, Eq. (10), a norm, not divided by the trace");
  add<&O::F_par>(c, "F_par", "", "F_par", "signed deviatoric fabric along the test's first shear direction");
  add<&O::shape_strain>(c, "shape_strain", "", "Lambda_eps", "shape factor of the strain (Table 1)");
  add<&O::shape_stress>(c, "shape_stress", "", "Lambda_sigma", "shape factor of the stress");
  add<&O::shape_fabric>(c, "shape_fabric", "", "Lambda_F", "shape factor of the fabric");
  add<&O::lode_strain>(c, "lode_strain", "deg", "theta_eps", "Lode angle of the strain (Table 1)");
  add<&O::lode_stress>(c, "lode_stress", "deg", "theta_sigma", "Lode angle of the stress");
  add<&O::lode_fabric>(c, "lode_fabric", "deg", "theta_F", "Lode angle of the fabric");
  add<&O::C_r>(c, "C_r", "", "C^r", "simple coordination number M/N");
  add<&O::C>(c, "C", "", "C", "modified coordination number M4/N");
  add<&O::C_star>(c, "C_star", "", "C*", "corrected coordination number M4/N4", true);
  add<&O::rattler_fraction>(c, "rattler_fraction", "", "phi_r", "fraction of spheres with fewer than 4 contacts", true);
  add<&O::mean_overlap>(c, "mean_overlap", "", "<Delta>_c", "mean overlap of contacts over the mean radius, Eq. (13)");
  add<&O::E_kin>(c, "E_kin", "J", "E_kin", "kinetic energy of the fluctuation velocities");
  add<&O::E_pot>(c, "E_pot", "J", "E_pot", "elastic energy of the contacts");
  add<&O::W_box>(c, "W_box", "J", "W", "work of the box since the start of the test");
  add<&O::D_contact>(c, "D_contact", "J", "D_c", "energy dissipated by contact viscosity since the start");
  add<&O::D_background>(c, "D_background", "J", "D_b", "energy dissipated by background drag since the start");
  add<&O::energy_residual>(c, "energy_residual", "", "", "(W - dE_pot - dE_kin - D)/(|W| + E_kin(0) + D)");
  add<&O::inertial_number>(c, "inertial_number", "", "I", "rate times 2<r> sqrt(rho/P)");
  return c;
}

}  // namespace

const std::vector<Column<Observation>>& observation_columns() {
  static const auto columns = make_observation_columns();
  return columns;
}

}  // namespace grainlaw
