#pragma once
// From a spec to its data set: every packing prepared, every test run, every series in one folder.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "dem/runs/run_list.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"
#include "model/files/path_file.hpp"

namespace grainlaw::dem {

/// All tests of the spec on all seeds, in the order of the spec within each seed.
std::vector<PlannedTest> plan(const Spec& spec);

// The DEM side of a prediction, the path on packings that the calibration has never seen:

/// Seeds for the path's runs: `wished`, else PATH's, else as many as the spec has, following the largest that were used: the
/// spec's and those of other `fitted` packings. Throws InvalidInput when one of them was.
std::vector<std::uint64_t> new_seeds(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& wished,
                                     const std::vector<std::uint64_t>& fitted, const std::string& name);

/// One test of role validation for each seed; packings are prepared as the spec says, keeping the path's density
/// besides the spec's `keep`. Throws InvalidInput when the density is not on its branch or the path would not end.
std::vector<PlannedTest> plan(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& seeds,
                              const std::string& name);

/// Throws InvalidInput where runs that are not finished in `parent`/runs cannot be made: LAMMPS is asked for and is not there.
/// To be called before anything is written.
void require_engines(const std::vector<PlannedTest>& tests, const std::filesystem::path& parent,
                     const Execution& execution);

/// The lock of the results in `folder`, which are written as a whole; waits for another process that writes there.
std::unique_ptr<ProcessLock> lock_results(const std::filesystem::path& folder, const Execution& execution);

/// Copies the series of finished runs to `folder` and writes dataset.json there last; series that an earlier dataset.json listed
/// and this one does not are removed. Returns what read_dataset would read there.
Dataset collect_runs(const std::vector<PlannedTest>& tests, const Json& spec, const std::filesystem::path& folder,
                     const RunStore& store, const Execution& execution);

/// Makes the runs first.
Dataset run_planned(const std::vector<PlannedTest>& tests, const Json& spec, const std::filesystem::path& folder,
                    const RunStore& store, const Execution& execution, RunCounts& counts);

}  // namespace grainlaw::dem
