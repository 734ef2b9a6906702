#pragma once
// Small-strain probe of a packing: elastic moduli of the state that it relaxes to at fixed cell.
//   dP = B dx + A1 de,  dsigma_par = A2 dx + DG de     x = -eps_vol, e = strain along N, sigma_par = <sigma',N>, <N,N> = 1
//   B = dP/dx,  DG = d sigma_par/de (= 2G),  A1 = dP/de,  A2 = d sigma_par/dx
// with N compression positive, in the norm of Eqs. (4) and (8). Twice over: by linear response, exact for unchanged
// contacts (dem/statics/linear_response.hpp), and by central differences of relaxed states at strains +h and -h,
// volumetric and along N, with what happened on the way there and back. Identity: A1 = (2/3)(A2 - sigma_par). Section 2
// of Kumar, Luding, Magnanimo, Acta Mech. 225 (2014) for the procedure; rattlers are set aside, they carry no load.

#include <limits>
#include <vector>

#include "dem/statics/balance.hpp"
#include "dem/statics/linear_response.hpp"
#include "model/vocabulary/probe_row.hpp"

namespace grainlaw::dem {

struct ProbeOptions {
  std::vector<double> steps{1e-6};   ///< h, each in (0, 0.01] [-]
  RelaxOptions relax{1e-9, 200000};  ///< of the whole packing, rattlers too, before it is probed
  int threads = 1;
};

/// The four moduli [Pa].
struct Moduli {
  double B = std::numeric_limits<double>::quiet_NaN();
  double DG = B, A1 = B, A2 = B;
};

/// What steps of one size show.
struct ElasticSteps {
  double h = 0;              ///< [-]
  Moduli central;            ///< central differences; NaN unless all four steps came to rest [Pa]
  double asymmetry_vol = 0;  ///< |y(+h) + y(-h) - 2 y(0)|/|y(+h) - y(-h)| for y = (P, sigma'), volumetric steps [-]
  double asymmetry_dev = 0;  ///< likewise, steps along N
  std::size_t contacts_closed = 0, contacts_opened = 0;  ///< against the state at rest, over the four steps
  int rearranged = 0;     ///< of the four steps, those that do not return: the state after +h (or -h) and back is off
  double hysteresis = 0;  ///< the largest of |y(there and back) - y(0)|/|y(there) - y(0)| [-]
  double residual = 0;    ///< largest max net force over mean contact force of the eight states at rest [-]
};

struct ElasticProbe {
  Observation state;         ///< the packing at rest; strain, path and energies are the caller's
  bool relaxed = false;      ///< the force tolerance was met
  double residual = 0;       ///< max net force over mean contact force of the load-carrying spheres [-]
  std::size_t spheres = 0;   ///< that carry load
  std::size_t contacts = 0;  ///< among them
  std::int64_t passes = 0;   ///< force passes of the first relaxation
  bool stable = false;       ///< the stiffness is positive; otherwise the moduli are NaN
  Moduli moduli;             ///< linear response [Pa]
  Tangent tangent = Tangent::Constant(std::numeric_limits<double>::quiet_NaN());  ///< all of it [Pa]
  double B_affine = Observation::undefined;  ///< B if every sphere followed the strain, an upper bound [Pa]
  std::vector<ElasticSteps> steps;
};

/// Relaxes a copy of `state` and probes it along `N`, |N| = 1. A state without load-carrying spheres yields NaN moduli.
/// Throws InvalidInput for options out of range, Interrupted.
ElasticProbe probe_moduli(State state, const Deviator<double>& N, const ProbeOptions& options,
                          const RunControl& control);

// A probe as rows of a table. Here, as in dem/engine/averages.hpp, units are dropped: moduli over k/(2<r>).

/// k/(2<r>): the stress of P* = 1 [Pa].
double stress_unit(const State& state);

/// One row for each step size of the probe; one without steps where nothing carries load.
std::vector<ProbeRow> rows_of(const ElasticProbe& probe, double stress_unit);

}  // namespace grainlaw::dem
