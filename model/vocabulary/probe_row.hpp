#pragma once
// What a small-strain probe shows of a packing at one place of a test: elastic moduli of the state that it relaxes to.
//   dP = B dx + A1 de,   dsigma_par = A2 dx + DG de     x = -eps_vol, e = strain along N, sigma_par = <sigma',N>
// N is the test's first shear direction, that of D2 where the test has none. The part inherited from Observation is the
// packing at rest, its strain that of the path. * means times 2<r>/k. One row for each place and step size.

#include "model/vocabulary/observation.hpp"

namespace grainlaw {

/// Meaning, symbol and unit of each member: the table below.
struct ProbeRow : Observation {
  bool relaxed = false;
  double residual = undefined;
  int spheres = 0;
  int contacts = 0;
  double B_star = undefined;
  double DG_star = undefined;
  double A1_star = undefined;
  double A2_star = undefined;
  double DG_mean_star = undefined;
  double B_affine_star = undefined;
  Stress A2_tensor_star;
  double step = undefined;
  double B_step_star = undefined;  ///< undefined, like the next three, unless all four states came to rest
  double DG_step_star = undefined;
  double A1_step_star = undefined;
  double A2_step_star = undefined;
  double asymmetry_vol = undefined;
  double asymmetry_dev = undefined;
  int contacts_closed = 0;
  int contacts_opened = 0;
  int rearranged = 0;
  double hysteresis = undefined;
  double step_residual = undefined;
};

/// The columns of probes.csv, in the order of writing.
constexpr auto fields_of(std::type_identity<ProbeRow>) {
  using R = ProbeRow;
  return std::tuple_cat(
      std::tuple{Field{&R::time, "time", "s", "t", "time since the start of the test"}}, place_fields<R>(Rule::plain),
      std::tuple{
          Field{&R::relaxed, "relaxed", "", "", "1: net forces are below 1e-9 of the mean contact force, else 0"},
          Field{&R::residual, "residual", "", "", "max net force over mean contact force of the load-carrying spheres"},
          Field{&R::spheres, "spheres", "", "", "spheres that carry load"},
          Field{&R::contacts, "contacts", "", "", "contacts among them"},
          Field{&R::stress, "stress", "Pa", "sigma", "stress at rest, compression positive"},
          Field{&R::P_star, "P_star", "", "P*", "pressure at rest times 2<r>/k, Eq. (7)"},
          Field{&R::s_dev, "s_dev", "", "s_dev", "stress ratio sigma_dev/P at rest, a norm"},
          Field{&R::s_par, "s_par", "", "s_par", "signed stress ratio at rest along the test's first shear direction"},
          Field{&R::fabric, "fabric", "", "F", "fabric tensor at rest, Eq. (9)"},
          Field{&R::F_v, "F_v", "", "F_v", "trace of the fabric"},
          Field{&R::F_dev, "F_dev", "", "F_dev", "deviatoric fabric, Eq. (10), a norm, not divided by the trace"},
          Field{&R::F_par, "F_par", "", "F_par", "signed deviatoric fabric along the test's first shear direction"},
          Field{&R::C_star, "C_star", "", "C*", "corrected coordination number M4/N4 at rest"},
          Field{&R::rattler_fraction, "rattler_fraction", "", "phi_r",
                "fraction of spheres with fewer than 4 contacts at rest"},
          Field{&R::B_star, "B_star", "", "B*", "bulk modulus dP*/dx, x = -eps_vol; contacts unchanged"},
          Field{&R::DG_star, "DG_star", "", "2G*",
                "shear modulus d sigma_par*/de along the test's first shear direction"},
          Field{&R::A1_star, "A1_star", "", "A1*", "coupling dP*/de"},
          Field{&R::A2_star, "A2_star", "", "A2*", "coupling d sigma_par*/dx; A1 = (2/3)(A2 - sigma_par)"},
          Field{&R::DG_mean_star, "DG_mean_star", "", "", "mean of DG_star over five orthogonal shear directions"},
          Field{&R::B_affine_star, "B_affine_star", "", "",
                "B_star if every sphere followed the strain, an upper bound"},
          Field{&R::A2_tensor_star, "A2_star", "", "A2*", "d sigma'*/dx"},
          Field{&R::step, "step", "", "h", "size of the finite strain steps"},
          Field{&R::B_step_star, "B_step_star", "", "B*",
                "central difference over steps +h and -h, spheres at rest again"},
          Field{&R::DG_step_star, "DG_step_star", "", "2G*", "likewise"},
          Field{&R::A1_step_star, "A1_step_star", "", "A1*", "likewise"},
          Field{&R::A2_step_star, "A2_step_star", "", "A2*", "likewise"},
          Field{&R::asymmetry_vol, "asymmetry_vol", "", "",
                "|y(+h) + y(-h) - 2 y(0)|/|y(+h) - y(-h)|, y = (P, sigma'), volumetric steps"},
          Field{&R::asymmetry_dev, "asymmetry_dev", "", "", "likewise, shear steps"},
          Field{&R::contacts_closed, "contacts_closed", "", "", "contacts that the four steps closed"},
          Field{&R::contacts_opened, "contacts_opened", "", "", "contacts that they opened"},
          Field{&R::rearranged, "rearranged", "", "",
                "of the four steps, those that do not return: hysteresis above 1e-3"},
          Field{&R::hysteresis, "hysteresis", "", "", "largest |y(there and back) - y(0)|/|y(there) - y(0)|"},
          Field{&R::step_residual, "step_residual", "", "", "largest residual of the states at rest after steps"}});
}

}  // namespace grainlaw
