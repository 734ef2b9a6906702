#pragma once
// Checkpoints of a run in its folder: `checkpoint` and the one before it, `checkpoint.previous`, which serves when the
// newer one is damaged.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "dem/files/checkpoint.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::dem {

/// How unfinished runs are treated.
struct ResumePolicy {
  bool resume = true;                           ///< go on from a checkpoint; false: start anew
  double checkpoint_interval = 60;              ///< wall time between two checkpoints [s]
  std::function<void(const std::string&)> log;  ///< told when a run goes on and what was damaged; may be empty
  std::string lammps = {}, launcher = {};       ///< as in Execution
};

/// For the run with this name.
ResumePolicy policy_of(const Execution& execution, const std::string& run);

class CheckpointFiles {
 public:
  /// `key` is that of the run; a checkpoint of another one is not taken.
  CheckpointFiles(std::filesystem::path folder, std::string key, const ResumePolicy& policy);

  /// The newest sound checkpoint; damaged ones are removed.
  std::optional<Checkpoint> load() const;

  /// Writes into the folder. Throws Error when that fails; the one before then stays.
  Checkpointing checkpointing() const;

 private:
  void save(const Checkpoint& checkpoint) const;

  std::filesystem::path folder_;
  std::string key_;
  const ResumePolicy& policy_;
};

}  // namespace grainlaw::dem
