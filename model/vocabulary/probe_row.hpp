#pragma once
// What a small-strain probe shows of a packing at one place of a test: elastic moduli of the state that it relaxes to.
//   dP = B dx + A1 de,   dsigma_par = A2 dx + DG de     x = -eps_vol, e = strain along N, sigma_par = <sigma',N>
// N is the test's first shear direction, that of D2 where the test has none. The part inherited from Observation is the
// packing at rest, its strain that of the path. * means times 2<r>/k. One row for each place and step size.

#include "model/vocabulary/observation.hpp"

namespace grainlaw {

struct ProbeRow : Observation {
  bool relaxed = false;              ///< the force tolerance was met
  double residual = undefined;       ///< max net force over mean contact force of the load-carrying spheres [-]
  int spheres = 0;                   ///< that carry load
  int contacts = 0;                  ///< among them
  double B_star = undefined;         ///< dP/dx, linear response with unchanged contacts [-]
  double DG_star = undefined;        ///< d sigma_par/de (= 2G) [-]
  double A1_star = undefined;        ///< dP/de = (2/3)(A2 - sigma_par) [-]
  double A2_star = undefined;        ///< d sigma_par/dx [-]
  double DG_mean_star = undefined;   ///< mean of DG over five orthogonal shear directions [-]
  double B_affine_star = undefined;  ///< B if every sphere followed the strain, an upper bound [-]
  Stress A2_tensor_star;             ///< dsigma'/dx [-]
  double step = undefined;           ///< h of the finite steps [-]
  double B_step_star = undefined;  ///< central differences over the steps +h and -h; undefined unless all came to rest
  double DG_step_star = undefined;
  double A1_step_star = undefined;
  double A2_step_star = undefined;
  double asymmetry_vol =
      undefined;  ///< |y(+h) + y(-h) - 2 y(0)|/|y(+h) - y(-h)|, y = (P, sigma'), volumetric steps [-]
  double asymmetry_dev = undefined;  ///< likewise, steps along N [-]
  int contacts_closed = 0;           ///< against the state at rest, over the four steps
  int contacts_opened = 0;
  int rearranged = 0;                ///< of the four steps, those that do not return
  double hysteresis = undefined;     ///< the largest |y(there and back) - y(0)|/|y(there) - y(0)| [-]
  double step_residual = undefined;  ///< the largest residual of the states at rest after steps [-]
};

}  // namespace grainlaw
