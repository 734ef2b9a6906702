#pragma once
// A state on disk: the file of a kept state, and the state as part of a checkpoint (dem/files/sealed_file.hpp).
//   header: particles, step, seed, digest, has_accelerations, has_list_reference; friction, rolling_friction, normal_force,
//   cohesion where they are not 0 or hooke
//   numbers: material, time, ledger, sums, H and ref_H by rows; radius, mass, s, v; a (if has_accelerations) and
//   reference fractions (if has_list_reference), each array whole; ids. SI units, in the order of dem/engine/state.hpp.

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "dem/engine/state.hpp"
#include "dem/files/sealed_file.hpp"

namespace grainlaw::dem {

inline constexpr std::string_view kStateMagic = "GRAINLAW";  ///< what the file begins with
inline constexpr std::uint32_t kStateFileVersion = 1;  ///< grows with every change of the layout

/// Throws Error naming the file when it cannot be written whole or a number is not finite; the earlier file under that
/// name then stays.
void write_state(const std::filesystem::path& file, const State& state, WriteFile write = write_durably);

/// The state bit for bit as written. Throws InvalidInput naming file and reason: damaged, other version, out of bounds.
State read_state(const std::filesystem::path& file);

/// The state as part of a file.
nlohmann::json state_header(const State& state);
void put_state(const State& state, NumberWriter& numbers);

/// Throws InvalidInput, or an exception of the JSON library, unless header and numbers make a sound state.
State take_state(const nlohmann::json& header, NumberReader& numbers);

}  // namespace grainlaw::dem
