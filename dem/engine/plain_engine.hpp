#pragma once
// Time steps in plain loops: double precision, any upper-triangular cell of any size, both kinds of transport. The precision
// "reference" that a user can choose, and what simulations fall back to where lanes do not fit. The state's arrays are
// current after each half of a step.

#include "dem/engine/contacts.hpp"
#include "dem/engine/neighbour_list.hpp"

namespace grainlaw::dem {

struct PlainEngine {
  NeighbourList list;
  std::vector<Row> place;           ///< positions [m] with radii
  std::vector<Row> motion;          ///< velocities predicted to the end of the step [m/s]
  std::vector<Row> force, viscous;  ///< contact forces and their viscous parts [N]
};

/// Makes the state's fractions and cell the reference of its list, wrapped.
void remember_reference(State& state);

/// The engine with a list at the state's positions, which become the reference.
PlainEngine start_plain(Stepping& s);

/// The engine with the list as it was at the reference of the state, which has one.
PlainEngine continue_plain(Stepping& s);

/// A new list at the state's positions, which become the reference.
void rebuild(PlainEngine& engine, Stepping& s);

/// Accelerations and sums of a state without them.
void first_forces(PlainEngine& engine, Stepping& s, const CellMotion& motion);

/// After that: throws InvalidInput for a sphere that would be thrown out of another one. Deep overlaps in equilibrium, of a
/// tiny sphere caught between large ones, may stay.
void refuse_deep_overlaps(const PlainEngine& engine, const Stepping& s, const CellMotion& motion);

/// First half of a step, from the cell start_H [m] to that of the state: half kick, drift, prediction of the velocities.
Drifted drift(PlainEngine& engine, Stepping& s, const Eigen::Matrix3d& start_H, const CellMotion& half,
              const CellMotion& end);

/// Second half: forces, then half a kick, drag treated implicitly. Every contact is met twice, once per sphere, so totals
/// take half of each meeting. The power lost in contacts is D = -sum_c f_v u_n - sum_i F_v,i . v_i with the velocities at
/// the end of the step. Returns the totals there.
PassSums kick(PlainEngine& engine, Stepping& s, const CellMotion& end);

}  // namespace grainlaw::dem
