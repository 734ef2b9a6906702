#pragma once
// The file of a kept state. Layout: dem/files/sealed_file.hpp (envelope), dem/files/state_record.hpp (content).

#include <cstdint>
#include <filesystem>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

inline constexpr std::uint32_t kStateFileVersion = 1;  ///< grows with every change of the layout

/// Throws Error naming the file when it cannot be written whole or a number is not finite; the earlier file under that
/// name then stays.
void write_state(const std::filesystem::path& file, const State& state);

/// The state bit for bit as written. Throws InvalidInput naming file and reason: damaged, other version, out of bounds.
State read_state(const std::filesystem::path& file);

}  // namespace grainlaw::dem
