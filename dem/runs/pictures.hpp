#pragma once
// pictures.json beside a data set: one packing before and after shear, as a plane through it shows it, for the report. Made
// from states that the runs leave in the store anyway; nothing reads it but the report, and no digest counts it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dem/runs/dataset_runs.hpp"
#include "dem/statics/packing_picture.hpp"

namespace grainlaw::dem {

inline constexpr const char* kPicturesFile = "pictures.json";

struct ShearPictures {
  std::string test;           ///< name of its record
  double nu = 0, strain = 0;  ///< where it starts; eps_dev of its path
  std::int64_t particles = 0;
  std::string horizontal, vertical;  ///< axes "x", "y", "z": of the fastest extension and compression
  PackingPicture before, after;
  std::string note = {};  ///< said beneath; of pictures that others have added
};

/// Of the calibration test of the plan's first seed that shears by D2 in one segment at the middle one of its densities;
/// written to `folder`. Without such a test, or its states in the store, a file of earlier runs is removed.
void write_pictures(const std::filesystem::path& folder, const std::vector<PlannedTest>& tests, const RunStore& store,
                    int threads);

/// The file of one data set for another's, or none.
void adopt_pictures(const std::filesystem::path& from, const std::filesystem::path& to);

/// Nothing where there is no file. Throws InvalidInput naming file and remedy when it is damaged.
std::optional<ShearPictures> read_pictures(const std::filesystem::path& folder);

}  // namespace grainlaw::dem
