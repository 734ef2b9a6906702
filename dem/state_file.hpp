#pragma once
// One file format for kept states and checkpoints: magic, format version, JSON header (counts, step, seed, digest),
// little-endian 64-bit numbers, SHA-256 of all that precedes. Written to a temporary name, synced and renamed, so a
// final name never holds half a file. Read: checksum first, then everything else. Layout: docs/formats.md.

#include <filesystem>

#include "dem/state.hpp"

namespace grainlaw::dem {

inline constexpr std::uint32_t kStateFileVersion = 1;  ///< grows with every change of the layout

/// Throws Error naming the file when it cannot be written whole or a number is not finite; the earlier file under that
/// name then stays.
void write_state(const std::filesystem::path& file, const State& state);

/// The state bit for bit as written. Throws InvalidInput naming file and reason: damaged, other version, out of bounds.
State read_state(const std::filesystem::path& file);

}  // namespace grainlaw::dem
