#pragma once
// The two kinds of run behind every command: the preparation of a packing and an element test. Each is looked up in the
// store first and executed only when it is not there.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/files/dataset.hpp"
#include "dem/runs/probe_json.hpp"
#include "dem/runs/checkpoint_files.hpp"
#include "dem/runs/run_store.hpp"
#include "dem/element_tests/preparation.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::dem {

/// Where an element test starts: a kept state of a preparation, or a given state.
struct TestStart {
  PreparationOptions preparation;             ///< engine and driving of the test; and the packing unless `given`
  int rows = 200;                                  ///< rows of each segment of the test
  std::optional<State> given;                 ///< of a table of spheres or a state file
  std::string given_digest;                        ///< SHA-256 of what `given` came from
  bool relax = false;                              ///< minimise `given` before the test
  std::optional<ProbePlan> probes = std::nullopt;  ///< small-strain probes along the test
};

/// What a run is a function of. The kept states and rows of a preparation do not change what others see of it.
Json preparation_request(const PreparationOptions& options);
Json test_request(const TestStart& start, const Path& path);

/// Runs the preparation unless it is in the store, from a checkpoint if there is one; its record (run.json). Files:
/// loading.csv, unloading.csv and one state file for each kept state. Interrupted leaves a checkpoint.
Json ensure_preparation(const RunStore& store, const PreparationOptions& options, const ResumePolicy& policy,
                        const RunControl& control);

/// Likewise an element test; a preparation that it needs must be in the store. Files: series.csv,
/// end.state, and probes.csv where the start asks for probes.
Json ensure_test(const RunStore& store, const TestStart& start, const Path& path, const ResumePolicy& policy,
                 const RunControl& control);

/// What a series on disk was measured on, from a run's record.
PackingInfo packing_from_record(const Json& record);
RunCost cost_from_record(const Json& record);

}  // namespace grainlaw::dem
