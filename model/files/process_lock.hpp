#pragma once
// A lock among processes, also of several machines on one network file system: a folder PLACE that holds one empty file, named after
// its owner. It is made beside PLACE and renamed to it, which a file system grants to one of those who try. Whoever finds the file of a
// dead owner removes it by its name, which no other owner has, and then tries like all others. A living owner touches its file
// at each heartbeat; it is dead when its process is no longer on this machine, or is on another and silent for kSilence.

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace grainlaw {

inline constexpr std::chrono::seconds kHeartbeat{20}, kSilence{300};

class ProcessLock {
 public:
  /// The lock PLACE in an existing folder; nothing when a living process, or another thread of this one, has it. Throws Error when the
  /// folder cannot be written to.
  static std::unique_ptr<ProcessLock> try_lock(const std::filesystem::path& place,
                                               std::chrono::milliseconds heartbeat = kHeartbeat);

  /// Waits for it; `busy` is told once who has it. Throws Interrupted.
  static std::unique_ptr<ProcessLock> wait(const std::filesystem::path& place, const std::stop_token& stop,
                                           const std::function<void(const std::string& owner)>& busy);

  /// Gives it back.
  ~ProcessLock();

  /// Requested when others believed this process dead, since it could not touch its file for kSilence, and took the lock.
  std::stop_token lost() const { return lost_.get_token(); }

 private:
  ProcessLock(std::filesystem::path file, std::chrono::milliseconds heartbeat);

  std::filesystem::path file_, folder_;
  std::stop_source lost_;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread heart_;
};

/// "process 4711 on node7", the living owner of the lock PLACE.
std::optional<std::string> lock_owner(const std::filesystem::path& place);

/// Removes what dead processes left of locks PLACE.lock in a folder.
void remove_dead_locks(const std::filesystem::path& folder);

}  // namespace grainlaw
