#pragma once
// TEST: what grainlaw simulate runs: the preparation of one packing, or one path from a kept state of it, from a table
// of spheres, or from a state file.

#include <filesystem>

#include "dem/runs/runs.hpp"

namespace grainlaw::dem {

enum class Start { preparation, kept, spheres, state };  ///< `preparation`: no path, the packing itself is the result

/// Engine and driving of the preparation hold for every start; its seed and kept states are set.
struct TestFile : TestSetup {
  Start start = Start::preparation;
  std::filesystem::path given_file = {};  ///< what `given` came from
};

/// Reads the file and those that it names (relative to its folder). Throws InvalidInput naming file, key or row.
TestFile read_test(const std::filesystem::path& file);

/// The same of a document that has been read, `name` in messages; the files that it names are relative to `folder`.
TestFile test_from_document(const Json& document, const std::filesystem::path& folder, const std::string& name);

}  // namespace grainlaw::dem
