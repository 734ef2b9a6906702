#include "dem/runs/checkpoint_files.hpp"

#include <fmt/format.h>

#include "dem/runs/run_store.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

namespace fs = std::filesystem;

ResumePolicy policy_of(const Execution& execution, const std::string& run) {
  return {execution.resume, execution.checkpoint_interval,
          [&watch = execution.watch, run](const std::string& text) { watch.log(run + ": " + text); }, execution.lammps,
          execution.launcher};
}

CheckpointFiles::CheckpointFiles(fs::path folder, std::string key, const ResumePolicy& policy)
    : folder_(std::move(folder)), key_(std::move(key)), policy_(policy) {}

std::optional<Checkpoint> CheckpointFiles::load() const {
  for (const char* name : {kCheckpoint, kPreviousCheckpoint}) {
    const fs::path file = folder_ / name;
    if (!fs::exists(file)) continue;
    try {
      Checkpoint checkpoint = read_checkpoint(file);
      if (checkpoint.state.digest != key_) throw InvalidInput(fmt::format("{}: is of another run", file.string()));
      if (policy_.log)
        policy_.log(fmt::format("goes on from the checkpoint at step {}", checkpoint.steps_before + checkpoint.steps));
      return checkpoint;
    } catch (const InvalidInput& why) {
      if (policy_.log) policy_.log(fmt::format("checkpoint not taken: {}", why.what()));
      fs::remove(file);
    }
  }
  return std::nullopt;
}

Checkpointing CheckpointFiles::checkpointing() const {
  return {[this](const Checkpoint& checkpoint) { save(checkpoint); }, policy_.checkpoint_interval};
}

void CheckpointFiles::save(const Checkpoint& checkpoint) const {
  const fs::path file = folder_ / kCheckpoint;
  std::error_code failure;
  if (fs::exists(file, failure)) fs::rename(file, folder_ / kPreviousCheckpoint, failure);
  if (failure) throw Error(fmt::format("{}: cannot be put aside: {}", file.string(), failure.message()));
  Checkpoint named = checkpoint;
  named.state.digest = key_;
  write_checkpoint(file, named);
}

}  // namespace grainlaw::dem
