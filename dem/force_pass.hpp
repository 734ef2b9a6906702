#pragma once
// The force pass: for each sphere the sum over its own contacts in the order of its sorted neighbours, and the totals
// of the energy account. One kernel for the two kinds of transport. Every contact is met twice (once per sphere), so
// totals take half of each meeting.

#include <cstddef>

#include "dem/contacts.hpp"
#include "dem/state.hpp"

namespace grainlaw::dem {

/// Contact forces on the spheres [begin, end) into out[i] = {fx, fy, fz, unused}; returns their share of the totals.
/// Throws Error naming both ids when two touching spheres share one position.
PassSums contact_forces(const ForceField& field, std::size_t begin, std::size_t end, Row* out);

}  // namespace grainlaw::dem
