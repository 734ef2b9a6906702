#pragma once
// The runs that tests need, each once: what commands simulate, what forecasts count and what tasks are made of.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dem/runs/runs.hpp"

namespace grainlaw::dem {

/// One test on one packing.
struct PlannedTest : TestSetup {
  std::string name;  ///< of the record
  Role role = Role::calibration;
  bool branch_of_preparation = false;  ///< ISO: the series that the preparation itself leaves
};

struct PlannedRun {
  std::string key;                   ///< in the store
  std::string name;                  ///< of the test, or "preparation-s1"
  const PlannedTest* test;           ///< the first that needs it
  bool is_preparation = false;       ///< of the test's packing
  std::optional<std::size_t> after;  ///< index of the preparation that a test starts from
};

/// Preparations first, then the tests in order. `tests` must outlive the list. InvalidInput where LAMMPS is to show frames or
/// probes.
std::vector<PlannedRun> runs_of(const std::vector<PlannedTest>& tests);

/// Key of the run whose series a test is.
std::string run_of(const PlannedTest& test);

/// Those of `runs` at these places, and before them the preparations that they start from.
std::vector<PlannedRun> with_preparations(const std::vector<PlannedRun>& runs, const std::vector<std::size_t>& places);

/// What becomes of runs that are not finished.
enum class MissingRuns {
  simulated,  ///< here, unless a living other does it, which is waited for
  awaited,    ///< others do them, now or later
};

/// What make_runs did.
struct RunCounts {
  std::size_t runs = 0;    ///< preparations and tests
  std::size_t found = 0;   ///< of those, finished before
  std::size_t others = 0;  ///< of those, finished meanwhile by other processes
};

/// Returns when all runs are in the store; nothing else changes. Those that are awaited are named to the watch, at the
/// begin and when interrupted.
void make_runs(const std::vector<PlannedRun>& runs, const RunStore& store, const Execution& execution,
               RunCounts& counts, MissingRuns missing = MissingRuns::simulated);

}  // namespace grainlaw::dem
