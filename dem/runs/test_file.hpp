#pragma once
// TEST: what grainlaw simulate runs: the preparation of one packing, or one path from a kept state of it, from a table
// of spheres, or from a state file.

#include <filesystem>
#include <optional>
#include <string>

#include "dem/runs/probe_json.hpp"
#include "dem/element_tests/preparation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

enum class Start { preparation, kept, spheres, state };  ///< `preparation`: no path, the packing itself is the result

struct TestFile {
  Start start = Start::preparation;
  PreparationOptions preparation;  ///< engine and driving hold for every start; seed and kept states are set
  std::optional<State> given;      ///< of `spheres` or `state`, as read
  std::string given_digest;             ///< SHA-256 of what `given` was read from, cell included
  bool relax = false;                   ///< minimise `given` before the test
  Path path;                            ///< nu: of the kept state, or of `given`
  std::optional<ProbePlan> probes = std::nullopt;  ///< small-strain probes along the path
};

/// Reads the file and those that it names (relative to its folder). Throws InvalidInput naming file, key or row.
TestFile read_test(const std::filesystem::path& file);

}  // namespace grainlaw::dem
