#pragma once
// Everything that a run is a function of from here on: saved states and checkpoints alike (dem/files/state_file.hpp).
// A run continued from a State equals the uninterrupted run bit by bit, so the state also carries what the integrator
// and the neighbour list remember.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "dem/engine/contact_law.hpp"
#include "dem/engine/packing.hpp"

namespace grainlaw::dem {

/// Energies since the ledger was opened [J]. W_box - D_contact - D_background = change of E_pot + E_kin.
struct Ledger {
  double W_box = 0;         ///< work of the box on the spheres, dW = -V sigma : L dt, sigma compression positive
  double D_contact = 0;     ///< dissipated by contact viscosity, >= 0
  double D_background = 0;  ///< dissipated by background drag, >= 0
  double E_start = 0;       ///< E_pot + E_kin when the ledger was opened
  double E_kin_start = 0;   ///< E_kin when the ledger was opened
};

/// Totals at the current time, made together with the forces.
struct PassSums {
  double box_power = 0;      ///< work of the box per time, -V sigma:L [W]
  double contact_power = 0;  ///< dissipation of contact viscosity [W]
  double E_pot = 0;          ///< elastic energy [J]
  double drag_power = 0;     ///< dissipation of background drag, from the velocities at the end of the step [W]
};

struct State {
  Material material;
  Packing packing;
  std::uint64_t step = 0;  ///< steps since the start of the current run
  double time = 0;         ///< time since the start of the current run [s]
  std::uint64_t seed = 0;  ///< key of the counter-based generator the packing came from
  Ledger ledger;
  std::vector<double> ax, ay, az;           ///< accelerations at the current time [m/s^2]; empty: not yet computed
  PassSums sums;                            ///< at the current time; meaningful when ax is not empty
  std::vector<double> ref_x, ref_y, ref_z;  ///< fractions at the last rebuild of the list [-]; empty: rebuild first
  Eigen::Matrix3d ref_H = Eigen::Matrix3d::Zero();  ///< cell at the last rebuild [m]
  std::string digest;     ///< SHA-256 (hex) of the resolved spec that made the state; may be empty
  ContactModel contacts;  ///< what made it; the engine itself knows k delta alone
};

/// The packing repeated `tiles` times along each edge of its cell, of the same material: large without being prepared
/// large. Ids are new; accelerations are not computed yet.
State tiled(const State& one, int tiles);

// The energy account: where the energy of a simulation comes from and goes to, work of the box, losses in contacts and
// to the background, by the trapezoidal rule over its steps, beside what it has.

/// Opens the energy account anew at the state, all of which must be current: ledger zero, E_start and E_kin_start
/// taken.
void open_ledger(State& state);

double kinetic_energy(const Packing& packing);  ///< of fluctuation velocities [J]

/// (W - dE - D)/(|W| + E_kin(0) + D) since the ledger was opened [-] (hard case D9); 0 when nothing happened.
double energy_residual(const State& state);

/// Enters a step of length dt [s] at whose end the totals are `sums`, which become those of the state.
void account(State& state, double dt, const PassSums& sums);

}  // namespace grainlaw::dem
