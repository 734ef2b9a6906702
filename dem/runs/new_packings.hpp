#pragma once
// The DEM side of a prediction: the path on packings that the calibration has never seen.

#include <cstdint>
#include <string>
#include <vector>

#include "model/files/path_file.hpp"
#include "dem/runs/spec_file.hpp"
#include "dem/runs/dataset_runs.hpp"

namespace grainlaw::dem {

/// Seeds for the path's runs: `wished`, else PATH's, else as many as the spec has, following its largest. Throws
/// InvalidInput when one of them belongs to the calibration.
std::vector<std::uint64_t> new_seeds(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& wished,
                                     const std::string& name);

/// One test of role validation for each seed; packings are prepared as the spec says, keeping the path's density
/// besides the spec's `keep`. Throws InvalidInput when the density is not on its branch or the path would not end.
std::vector<PlannedTest> plan(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& seeds,
                              const std::string& name);

}  // namespace grainlaw::dem
