#pragma once
// One file format for kept states and checkpoints; integers and doubles little-endian:
//   "GRAINLAW" | version u32 | length of the header u32 | header, JSON | numbers, 8 bytes each | SHA-256 of all before
//   numbers: material, time, ledger, sums, H and ref_H by rows; radius, mass, s, v; a (if has_accelerations) and
//   reference fractions (if has_list_reference), each array whole; ids. SI units, in the order of dem/state.hpp.
// Written to a temporary name, synced and renamed, so a final name never holds half a file. Read: checksum first, then
// everything else.

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
