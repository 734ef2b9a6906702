#pragma once
// Finished runs, found again by what they are a function of: FOLDER/<key>/ holds a run's files and, written last,
// run.json with their digests. The key is the SHA-256 of the canonical JSON of the request and the engine's version.
// The folder of an unfinished run holds what it can go on from. Many processes, also on many machines, work in a store at a
// time: whoever makes a run holds its lock, FOLDER/<key>.lock.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "model/files/json_document.hpp"
#include "model/files/process_lock.hpp"

namespace grainlaw::dem {

/// 64 hexadecimal digits. `request` must hold everything that changes the result and nothing else.
std::string run_key(const Json& request);

/// Whether FOLDER/<key> holds a finished run, for those who only look: nothing is locked, no digest is compared.
bool is_finished(const std::filesystem::path& folder, const std::string& key);

/// Who makes the run now, "process 4711 on node7"; for those who only look, too.
std::optional<std::string> maker_of(const std::filesystem::path& folder, const std::string& key);

/// Scratch files of a run in progress.
inline constexpr const char* kCheckpoint = "checkpoint";
inline constexpr const char* kPreviousCheckpoint = "checkpoint.previous";
inline constexpr const char* kProgress = "progress.json";  ///< what a preparation has yielded so far

class RunStore {
 public:
  /// Creates parent/name when absent and removes the locks of dead processes. The destructor removes it if it is still empty.
  RunStore(const std::filesystem::path& parent, const std::string& name);
  ~RunStore();
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path folder(const std::string& key) const;

  /// The right to make the run, while it is held: for begin(), reopen(), set_aside_damaged() and finish() where others may work, too.
  /// Nothing when a living other has it.
  std::unique_ptr<ProcessLock> try_lock(const std::string& key) const;

  /// run.json of a finished run that is whole and whose files are as they were written; nothing otherwise. Scratch files that a kill left
  /// beside a finished run are removed. Throws Error when the system fails to read what is there: that is no damage.
  std::optional<Json> find(const std::string& key) const;

  /// The same of a run that was finished before. Throws Error when it no longer is.
  Json finished(const std::string& key) const;

  /// Puts the folder of a finished run that find() does not accept aside as KEY.damaged, for whoever wants to look; returns its
  /// run.json as it was, nothing when there is no such folder.
  std::optional<std::filesystem::path> set_aside_damaged(const std::string& key) const;

  /// An empty folder for the run; what an unfinished or damaged run left there is removed.
  std::filesystem::path begin(const std::string& key) const;

  /// The folder of an unfinished run as it is, or an empty one; a damaged one is to be put aside before.
  std::filesystem::path reopen(const std::string& key) const;

  /// Writes run.json: {format, key, request, `record`'s keys, files: {name: SHA-256}, sha256 of all these}, then removes the scratch
  /// files. Returns it as find() would.
  Json finish(const std::string& key, const Json& request, const OrderedJson& record) const;

 private:
  std::filesystem::path root_;
};

}  // namespace grainlaw::dem
