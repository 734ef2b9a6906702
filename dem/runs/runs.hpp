#pragma once
// The two kinds of run behind every command: the preparation of a packing and an element test. Each is looked up in the
// store first and executed only when it is not there; who calls has the run's lock where others may work in the store.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dem/element_tests/preparation.hpp"
#include "dem/runs/checkpoint_files.hpp"
#include "dem/runs/path_probes.hpp"
#include "dem/runs/run_store.hpp"
#include "model/files/dataset.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::dem {

/// An element test: where it starts, a kept state of a preparation or a given state, and its way from there.
struct TestSetup {
  PreparationOptions preparation;             ///< engine and driving of the test; and the packing unless `given`
  Path path;                                  ///< nu: of the kept state, or of `given`
  int rows = 200;                             ///< rows of each segment of the test
  std::optional<State> given = std::nullopt;  ///< of a table of spheres or a state file, as read
  std::string given_digest = {};              ///< SHA-256 of what `given` came from, cell included
  bool relax = false;                         ///< minimise `given` before the test
  std::optional<ProbeRequest> probes = std::nullopt;  ///< small-strain probes along the test
  int frames = 0;  ///< states kept on the way of each segment, at equal steps of the path
};

/// The key of a run in the store, from what it is a function of. The kept states and rows of a preparation do not
/// change what others see of it.
std::string preparation_key(const PreparationOptions& options);
std::string test_key(const TestSetup& test);

/// What each is expected to take, without relaxations [particle-steps].
double expected_work(const PreparationOptions& options);
double expected_work(const TestSetup& test);

/// Runs the preparation unless it is in the store, from a checkpoint if there is one; its record (run.json). Files:
/// loading.csv, unloading.csv and one state file for each kept state. Interrupted leaves a checkpoint.
Json ensure_preparation(const RunStore& store, const PreparationOptions& options, const ResumePolicy& policy,
                        const RunControl& control);

/// Likewise an element test; a preparation that it needs must be in the store. Files: series.csv,
/// end.state, probes.csv where it asks for probes, and the states and frames.csv of path_frames.hpp.
Json ensure_test(const RunStore& store, const TestSetup& test, const ResumePolicy& policy, const RunControl& control);

/// What a series on disk was measured on, from a run's record.
PackingInfo packing_from_record(const Json& record);
RunCost cost_from_record(const Json& record);

}  // namespace grainlaw::dem
