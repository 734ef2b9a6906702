#pragma once
// The force pass: for each sphere the sum over its own contacts in the order of its sorted neighbours, and the totals
// of the energy account. One kernel for the two kinds of transport. Every contact is met twice (once per sphere), so
// totals take half of each meeting.

#include <cstddef>

#include "dem/engine/contacts.hpp"
#include "dem/engine/state.hpp"

namespace grainlaw::dem {

/// Contact forces on the spheres [begin, end) into force[i] = {fx, fy, fz, unused}, their viscous parts likewise into
/// viscous[i]; returns the share of the totals. Of the power lost in contacts that is only the part of the cell's motion,
///   D = -sum_c f_v u_n - sum_i F_v,i . v_i,
/// because the velocities at the end of the step are known after the forces only. Throws Error naming both ids when two touching spheres share one position.
PassSums contact_forces(const ForceField& field, std::size_t begin, std::size_t end, Row* force, Row* viscous);

}  // namespace grainlaw::dem
