#pragma once
// From a spec to its data set: every packing prepared, every test run, every series in one folder.

#include <filesystem>
#include <optional>
#include <vector>

#include "model/files/dataset.hpp"
#include "dem/runs/spec_file.hpp"
#include "dem/runs/run_store.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::dem {

/// One test on one packing.
struct PlannedTest {
  std::string name;  ///< of the record
  Role role = Role::calibration;
  Path path;
  PreparationOptions preparation;             ///< of its packing
  int rows = 200;                                  ///< of each segment
  bool branch_of_preparation = false;              ///< ISO: the series that the preparation itself leaves
  std::optional<ProbePlan> probes = std::nullopt;  ///< small-strain probes along the test
};

/// All tests of the spec on all seeds, in the order of the spec within each seed.
std::vector<PlannedTest> plan(const Spec& spec);

/// What run_planned did.
struct RunCounts {
  std::size_t runs = 0;   ///< preparations and tests
  std::size_t found = 0;  ///< of those, finished before
};

/// Runs what is not in the store yet, copies the series to `folder` and writes dataset.json there last; series that an
/// earlier dataset.json listed and this one does not are removed. Returns what read_dataset would read there.
Dataset run_planned(const std::vector<PlannedTest>& tests, const Json& spec, const std::filesystem::path& folder,
                    const RunStore& store, const Execution& execution, RunCounts& counts);

}  // namespace grainlaw::dem
