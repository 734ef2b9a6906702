#pragma once
// One packing or one element test, as TEST asks for it, from the file to a folder of results.

#include <filesystem>
#include <vector>

#include "dem/runs/test_file.hpp"
#include "model/files/execution.hpp"
#include "model/files/json_document.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

struct SimulationResult {
  std::vector<Observation> rows;                ///< the series; of a preparation that of its unloading branch
  std::vector<std::string> warnings;            ///< of the run
  OrderedJson summary = OrderedJson::object();  ///< what simulation.json holds
};

/// Runs `test` unless `output`/runs has it, and copies its series and states to `output`, with simulation.json and, of a
/// test, end.csv. Throws what the engine throws; Interrupted leaves a checkpoint that the next call goes on from.
SimulationResult simulate(const TestFile& test, const std::filesystem::path& output, const Execution& execution);

}  // namespace grainlaw::dem
