#include "model/files/process_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "model/files/digest.hpp"
#include "model/files/number_text.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCandidate = ".lock-";  // a lock before it is renamed into place

/// A process, and in which of its locks: the name of an owner's file is HOST,PID,START,MACHINE,COUNT.
struct Owner {
  std::string host;
  pid_t pid = 0;
  std::string start;    ///< of the process, ticks since boot: a number of a process is given again
  std::string machine;  ///< of one boot and one set of process numbers
};

std::string first_line(const char* file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

std::string link_target(const char* link) {
  std::error_code error;
  return fs::read_symlink(link, error).string();
}

/// Empty where /proc does not say: then nobody is known to be on the same machine.
const std::string& this_machine() {
  static const std::string machine = [] {
    const std::string boot = first_line("/proc/sys/kernel/random/boot_id"), pids = link_target("/proc/self/ns/pid");
    return boot.empty() || pids.empty() ? "" : sha256(boot + pids).substr(0, 16);
  }();
  return machine;
}

/// Field 22 of /proc/PID/stat; empty for a process that has ended, though nobody has asked for its exit code, or is none.
std::string start_of(pid_t pid) {
  std::string stat = first_line(fmt::format("/proc/{}/stat", pid).c_str());
  stat.erase(0, std::min(stat.rfind(')'), stat.size()));
  std::vector<std::string> fields;  // the first is ')', that of the state the second
  for (std::size_t begin = 0, end = 0; begin < stat.size(); begin = end + 1) {
    end = std::min(stat.find(' ', begin), stat.size());
    fields.push_back(stat.substr(begin, end - begin));
  }
  return fields.size() < 21 || fields[1] == "Z" || fields[1] == "X" ? "" : fields[20];
}

std::string this_host() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  gethostname(name.data(), name.size() - 1);
  std::string host = name.data();
  for (char& c : host) {
    if (c == '/' || c == ',' || static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return host;
}

std::string new_owner() {
  static std::atomic<unsigned> count{0};
  return fmt::format("{},{},{},{},{}", this_host(), getpid(), start_of(getpid()), this_machine(), count++);
}

std::optional<Owner> owner_of(const std::string& name) {
  std::vector<std::string> parts{""};
  for (const char c : name) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  Owner owner{parts[0], 0, "", ""};
  if (parts.size() != 5) return std::nullopt;
  const auto pid = number_of<decltype(owner.pid)>(parts[1]);
  if (!pid || *pid <= 0) return std::nullopt;
  owner.pid = *pid;
  owner.start = parts[2];
  owner.machine = parts[3];
  return owner;
}

/// What the machine that holds the folder takes for now; nothing where it cannot be written to.
std::optional<fs::file_time_type> now_in(const fs::path& folder) {
  const fs::path file = folder / fmt::format("{}now-{}", kCandidate, new_owner());
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return std::nullopt;
  close(descriptor);
  std::error_code error;
  const fs::file_time_type now = fs::last_write_time(file, error);
  unlink(file.c_str());
  return error ? std::nullopt : std::optional(now);
}

bool is_alive(const Owner& owner, const fs::path& file) {
  if (!this_machine().empty() && owner.machine == this_machine()) {
    if (kill(owner.pid, 0) == 0) return start_of(owner.pid) == owner.start;
    if (errno == ESRCH) return false;  // else it is another user's, which may be looked at from outside only
  }
  std::error_code error;
  const fs::file_time_type touched = fs::last_write_time(file, error);
  if (error) return false;  // gone in between
  const auto now = now_in(file.parent_path().parent_path());
  return now.value_or(fs::file_time_type::clock::now()) - touched < kSilence;
}

/// Removes the files of dead owners in a lock; the living one.
std::optional<Owner> living_owner(const fs::path& place) {
  if (fs::is_symlink(fs::symlink_status(place)))
    throw InvalidInput(fmt::format("{}: is a symbolic link where a lock is needed; remove it", place.string()));
  for (const fs::path& file : entries_of(place)) {
    const auto owner = owner_of(file.filename().string());
    if (!owner) continue;
    if (is_alive(*owner, file)) return owner;
    unlink(file.c_str());
  }
  return std::nullopt;
}

std::string text_of(const Owner& owner) { return fmt::format("process {} on {}", owner.pid, owner.host); }

[[noreturn]] void fail(const fs::path& place) {
  throw Error(fmt::format("{}: cannot be locked ({}); check space and permissions, remove what is not grainlaw's",
                          place.string(), std::strerror(errno)));
}

}  // namespace

ProcessLock::ProcessLock(fs::path file, std::chrono::milliseconds heartbeat)
    : file_(std::move(file)), folder_(file_.parent_path()) {
  heart_ = std::jthread([this, heartbeat](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_for(lock, stop, heartbeat, [&] { return stop.stop_requested(); })) {
      if (utimensat(AT_FDCWD, file_.c_str(), nullptr, 0) != 0 && (errno == ENOENT || errno == ESTALE)) {
        lost_.request_stop();
        return;
      }
    }
  });
}

ProcessLock::~ProcessLock() {
  heart_.request_stop();
  heart_.join();
  unlink(file_.c_str());
  rmdir(folder_.c_str());  // unless another has it already
}

std::unique_ptr<ProcessLock> ProcessLock::try_lock(const fs::path& place, std::chrono::milliseconds heartbeat) {
  constexpr int kTries = 100;  // as others take it, give it back and tidy up at the same time
  for (int tries = 0; tries < kTries; ++tries) {
    if (living_owner(place)) return nullptr;
    const std::string owner = new_owner();
    const fs::path candidate = place.parent_path() / fmt::format("{}{}", kCandidate, owner);
    if (mkdir(candidate.c_str(), 0777) != 0) fail(place);
    const fs::path sign = candidate / owner;
    const int file = open(sign.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    const bool renamed = file >= 0 && close(file) == 0 && std::rename(candidate.c_str(), place.c_str()) == 0;
    const int error = errno;
    // a network file system may say no to what it has done
    if (fs::exists(fs::symlink_status(place / owner)))
      return std::unique_ptr<ProcessLock>(new ProcessLock(place / owner, heartbeat));
    unlink(sign.c_str());
    rmdir(candidate.c_str());
    errno = error;
    if (!renamed && errno != ENOTEMPTY && errno != EEXIST && errno != ENOENT) fail(place);
  }
  fail(place);
}

std::unique_ptr<ProcessLock> ProcessLock::wait(const fs::path& place, const std::stop_token& stop,
                                               const std::function<void(const std::string& owner)>& busy) {
  std::mutex mutex;
  std::condition_variable_any never;
  for (bool told = false; !stop.stop_requested(); told = true) {
    if (auto lock = try_lock(place)) return lock;
    if (!told) busy(lock_owner(place).value_or("another process"));
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
  }
  throw Interrupted(fmt::format("interrupted while waiting for {}", place.string()));
}

std::optional<std::string> lock_owner(const fs::path& place) {
  for (const fs::path& file : entries_of(place)) {
    const auto owner = owner_of(file.filename().string());
    if (owner && is_alive(*owner, file)) return text_of(*owner);
  }
  return std::nullopt;
}

void remove_dead_locks(const fs::path& folder) {
  for (const fs::path& entry : entries_of(folder)) {
    const std::string name = entry.filename().string();
    std::error_code ignored;  // what cannot be removed does no harm
    if (name.ends_with(".lock") && fs::is_directory(fs::symlink_status(entry))) {
      if (!living_owner(entry)) rmdir(entry.c_str());
    } else if (name.starts_with(kCandidate)) {
      const auto owner = owner_of(name.substr(name.rfind('-', name.find(',')) + 1));
      if (owner && !is_alive(*owner, entry)) fs::remove_all(entry, ignored);
    }
  }
}

}  // namespace grainlaw
