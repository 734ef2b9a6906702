#pragma once
// A state as part of a file (dem/files/sealed_file.hpp). Private to this room, like that one: users read and write whole files.
//   header: particles, step, seed, digest, has_accelerations, has_list_reference
//   numbers: material, time, ledger, sums, H and ref_H by rows; radius, mass, s, v; a (if has_accelerations) and
//   reference fractions (if has_list_reference), each array whole; ids. SI units, in the order of dem/engine/state.hpp.

#include "dem/files/sealed_file.hpp"
#include "dem/engine/state.hpp"

namespace grainlaw::dem {

nlohmann::json state_header(const State& state);
void put_state(const State& state, NumberWriter& numbers);

/// Throws InvalidInput, or an exception of the JSON library, unless header and numbers make a sound state.
State take_state(const nlohmann::json& header, NumberReader& numbers);

}  // namespace grainlaw::dem
