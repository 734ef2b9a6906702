#pragma once
// States, runs and data sets as files of other programs (docs/formats.md, Formats out).

#include <filesystem>
#include <string>
#include <vector>

#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::chain {

enum class ExportFormat { vtp, xyz, lammps_data, lammps_dump, vtkhdf, npz, csv };
constexpr auto names_of(ExportFormat) {
  return std::array{"vtp", "xyz", "lammps-data", "lammps-dump", "vtkhdf", "npz", "csv"};
}

struct Exported {
  std::size_t states = 0, series = 0;  ///< that were written
  std::vector<std::string> files;      ///< names in the folder
};

/// Writes `source` to the folder `output`: a state file; a folder of `grainlaw simulate`, of which the frames are taken in
/// their order, or else the states that it holds; for npz and csv the series of such a folder or of a data set. Throws
/// InvalidInput when there is nothing of the kind; Interrupted.
Exported export_files(const std::filesystem::path& source, ExportFormat format, const std::filesystem::path& output,
                      const RunControl& control);

}  // namespace grainlaw::chain
