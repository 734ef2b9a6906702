#pragma once
// Where a run in progress stands. A run continued from a checkpoint equals the uninterrupted one bit by bit.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "dem/engine/state.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

struct Checkpoint {
  std::string stage;                                    ///< of a preparation; empty for an element test
  std::uint64_t steps_before = 0;                       ///< time steps of a preparation's earlier stages
  int segment = 0;                                      ///< of the path
  Eigen::Matrix3d segment_H = Eigen::Matrix3d::Zero();  ///< cell at the start of that segment [m]
  std::uint64_t segment_steps = 0;                      ///< time steps of the segment that are done, at least 1
  std::uint64_t steps = 0;                              ///< time steps of the whole test that are done
  double time_step = 0;                                 ///< largest dt so far [s]
  double seconds = 0;                                   ///< wall time so far [s]
  std::vector<Observation> rows;                        ///< the series so far
  State state;                                          ///< after the last of those steps
};

/// How a run saves itself on its way. Its results do not depend on it.
struct Checkpointing {
  std::function<void(const Checkpoint&)>
      save;              ///< called between two steps and before Interrupted is thrown; may be empty
  double interval = 60;  ///< wall time between two calls [s]; 0: after every step
};

/// Layout: dem/files/sealed_file.hpp. Errors as in dem/files/state_file.hpp.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);
Checkpoint read_checkpoint(const std::filesystem::path& file);

}  // namespace grainlaw::dem
