#pragma once
// A snapshot as VTKHDF by the C library of HDF5: an UnstructuredGrid of vertices, the type of points that the reader of VTK 9.1
// (Debian 12, ParaView 5.11) opens. Point data id, radius, velocity; field data time and cell.

#include <filesystem>

#include "dem/export/snapshot.hpp"

namespace grainlaw::dem {

/// Throws Error naming the file when it cannot be written whole; nothing stays under the name then.
void write_vtkhdf(const std::filesystem::path& file, const Snapshot& snapshot);

}  // namespace grainlaw::dem
