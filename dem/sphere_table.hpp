#pragma once
// A packing from a table of spheres: CSV with the columns id, x, y, z, r, vx, vy, vz (any order, header required; SI
// units; velocities may be left out) in a cell given beside it.

#include <filesystem>

#include "dem/state.hpp"

namespace grainlaw::dem {

/// Reads the table. `cell` is H: upper triangular, columns are edge vectors [m]. Throws InvalidInput naming file, row
/// and column. Bounded memory: at most 1e8 rows, lines of at most 1 MB.
State read_spheres(const std::filesystem::path& file, const Eigen::Matrix3d& cell, const Material& material);

/// Writes the same columns, positions wrapped into the cell. Throws Error when the file cannot be written.
void write_spheres(const std::filesystem::path& file, const Packing& packing);

}  // namespace grainlaw::dem
