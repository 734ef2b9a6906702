#include "model/files/probe_columns.hpp"

#include "model/files/csv_table.hpp"

namespace grainlaw {
namespace {

void add_state(Columns<ProbeRow>& c) {
  using R = ProbeRow;
  add<&R::time>(c, "time", "s", "t", "time since the start of the test");
  add<&R::segment>(c, "segment", "", "", "index of the path's segment, from 0");
  add_tensor<&R::strain>(c, "strain", "", "eps", "logarithmic strain since the start of the test, tension positive");
  add<&R::eps_vol>(c, "eps_vol", "", "eps_vol", "volumetric strain ln(V/V0), negative in compression");
  add<&R::eps_dev>(c, "eps_dev", "", "eps_dev", "deviatoric strain, Eq. (4)");
  add<&R::shear_path>(c, "shear_path", "", "", "integral of |d eps_dev|, grows on reversal too");
  add<&R::nu>(c, "nu", "", "nu", "volume fraction");
  add<&R::relaxed>(c, "relaxed", "", "", "1: net forces are below 1e-9 of the mean contact force, else 0");
  add<&R::residual>(c, "residual", "", "", "max net force over mean contact force of the load-carrying spheres");
  add<&R::spheres>(c, "spheres", "", "", "spheres that carry load");
  add<&R::contacts>(c, "contacts", "", "", "contacts among them");
  add_tensor<&R::stress>(c, "stress", "Pa", "sigma", "stress at rest, compression positive");
  add<&R::P_star>(c, "P_star", "", "P*", "pressure at rest times 2<r>/k, Eq. (7)");
  add<&R::s_dev>(c, "s_dev", "", "s_dev", "stress ratio sigma_dev/P at rest, a norm");
  add<&R::s_par>(c, "s_par", "", "s_par", "signed stress ratio at rest along the test's first shear direction");
  add_tensor<&R::fabric>(c, "fabric", "", "F", "fabric tensor at rest, Eq. (9)");
  add<&R::F_v>(c, "F_v", "", "F_v", "trace of the fabric");
  add<&R::F_dev>(c, "F_dev", "", "F_dev", "deviatoric fabric, Eq. (10), a norm, not divided by the trace");
  add<&R::F_par>(c, "F_par", "", "F_par", "signed deviatoric fabric along the test's first shear direction");
  add<&R::C_star>(c, "C_star", "", "C*", "corrected coordination number M4/N4 at rest");
  add<&R::rattler_fraction>(c, "rattler_fraction", "", "phi_r",
                            "fraction of spheres with fewer than 4 contacts at rest");
}

void add_moduli(Columns<ProbeRow>& c) {
  using R = ProbeRow;
  add<&R::B_star>(c, "B_star", "", "B*", "bulk modulus dP*/dx, x = -eps_vol; contacts unchanged");
  add<&R::DG_star>(c, "DG_star", "", "2G*", "shear modulus d sigma_par*/de along the test's first shear direction");
  add<&R::A1_star>(c, "A1_star", "", "A1*", "coupling dP*/de");
  add<&R::A2_star>(c, "A2_star", "", "A2*", "coupling d sigma_par*/dx; A1 = (2/3)(A2 - sigma_par)");
  add<&R::DG_mean_star>(c, "DG_mean_star", "", "", "mean of DG_star over five orthogonal shear directions");
  add<&R::B_affine_star>(c, "B_affine_star", "", "", "B_star if every sphere followed the strain, an upper bound");
  add_tensor<&R::A2_tensor_star>(c, "A2_star", "", "A2*", "d sigma'*/dx");
}

void add_steps(Columns<ProbeRow>& c) {
  using R = ProbeRow;
  add<&R::step>(c, "step", "", "h", "size of the finite strain steps");
  add<&R::B_step_star>(c, "B_step_star", "", "B*", "central difference over steps +h and -h, spheres at rest again");
  add<&R::DG_step_star>(c, "DG_step_star", "", "2G*", "likewise");
  add<&R::A1_step_star>(c, "A1_step_star", "", "A1*", "likewise");
  add<&R::A2_step_star>(c, "A2_step_star", "", "A2*", "likewise");
  add<&R::asymmetry_vol>(c, "asymmetry_vol", "", "",
                         "|y(+h) + y(-h) - 2 y(0)|/|y(+h) - y(-h)|, y = (P, sigma'), volumetric steps");
  add<&R::asymmetry_dev>(c, "asymmetry_dev", "", "", "likewise, shear steps");
  add<&R::contacts_closed>(c, "contacts_closed", "", "", "contacts that the four steps closed");
  add<&R::contacts_opened>(c, "contacts_opened", "", "", "contacts that they opened");
  add<&R::rearranged>(c, "rearranged", "", "", "of the four steps, those that do not return: hysteresis above 1e-3");
  add<&R::hysteresis>(c, "hysteresis", "", "", "largest |y(there and back) - y(0)|/|y(there) - y(0)|");
  add<&R::step_residual>(c, "step_residual", "", "", "largest residual of the states at rest after steps");
}

template <class Field>
std::string joined(const Field& field) {
  std::string text;
  for (const auto& column : probe_columns()) text.append(text.empty() ? "" : ",").append(field(column));
  return text;
}

}  // namespace

const std::vector<Column<ProbeRow>>& probe_columns() {
  static const auto columns = [] {
    Columns<ProbeRow> c;
    add_state(c);
    add_moduli(c);
    add_steps(c);
    return c;
  }();
  return columns;
}

std::string probe_header() {
  return joined([](const auto& column) { return column.title(); });
}

std::string probe_line(const ProbeRow& row) {
  return joined([&](const auto& column) { return csv_number(column.get(row)); });
}

}  // namespace grainlaw
