#pragma once
// A packing from a table of spheres: CSV with the columns id, x, y, z, r, vx, vy, vz (any order, header required,
// units [m], [m/s] in the header are checked; velocities may be left out) in a cell given beside it. SI units.

#include <filesystem>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

/// Reads the table. `cell` is H: upper triangular, columns are edge vectors [m]. Throws InvalidInput naming file, line
/// (the header is line 1) and column. Bounded memory: at most 1e8 rows, lines of at most 1 MB. Spheres that
/// no cell of this size can hold (solid volume above twice the cell's, radius above twice its smallest height) and
/// positions more than 1000 cells away are refused: their units are most likely wrong.
State read_spheres(const std::filesystem::path& file, const Eigen::Matrix3d& cell, const Material& material);

/// Writes the same columns, positions wrapped into the cell, numbers that read back equal. Throws Error when the file
/// cannot be written or a number is not finite.
void write_spheres(const std::filesystem::path& file, const Packing& packing);

}  // namespace grainlaw::dem
