#pragma once
// One file format for kept states and checkpoints: magic, format version, JSON header (counts, material, step, seed,
// digests), little-endian doubles, SHA-256 of all that precedes. Written to a temporary name, synced and renamed, so a
// final name never holds half a file. Read: checksum first, then everything else.

#include <filesystem>

#include "dem/state.hpp"

namespace grainlaw::dem {

/// Throws Error naming the file when it cannot be written whole; the earlier file under that name then stays.
void write_state(const std::filesystem::path& file, const State& state);

/// The state bit for bit as written. Throws InvalidInput naming file and reason: damaged, other version, out of bounds.
State read_state(const std::filesystem::path& file);

}  // namespace grainlaw::dem
