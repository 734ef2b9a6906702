#include "model/files/durable_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

constexpr std::string_view kMark = ".tmp-";

/// Hidden, and different for threads that write at the same time: .NAME.tmp-PROCESS-COUNT
fs::path temporary_name(const fs::path& file) {
  static std::atomic<unsigned> count{0};
  return folder_of(file) / fmt::format(".{}{}{}-{}", file.filename().string(), kMark, ::getpid(), count++);
}

/// Whether a name is one that temporary_name() gives.
bool is_temporary(const std::string& name) { return name.starts_with('.') && name.find(kMark) != std::string::npos; }

/// A file that disappears unless it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& final_name) : final_(final_name), name_(temporary_name(final_name)) {
    // O_EXCL and O_NOFOLLOW: never write through a link that somebody placed there
    ::unlink(name_.c_str());
    descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("created");
    ::flock(descriptor_, LOCK_EX | LOCK_NB);  // ends with the process: see remove_leftovers
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write_all(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("written");
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void rename_to_final() {
    if (::fsync(descriptor_) != 0) fail("synced");
    // some file systems report a failed write only here
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("closed");
    if (std::rename(name_.c_str(), final_.c_str()) != 0) fail("renamed into place");
    renamed_ = true;
    const int folder = ::open(folder_of(final_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) fail("synced");
    // EINVAL: a file system that cannot sync folders has nothing to sync
    const int error = ::fsync(folder) != 0 && errno != EINVAL ? errno : 0;
    ::close(folder);
    errno = error;
    if (error != 0) fail("synced");
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(fmt::format("{}: cannot be {} ({}); check space and permissions", final_.string(), what,
                            std::strerror(errno)));
  }

  fs::path final_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

}  // namespace

void write_durably(const fs::path& file, std::string_view bytes) {
  TemporaryFile temporary(file);
  temporary.write_all(bytes);
  temporary.rename_to_final();
}

void copy_durably(const fs::path& from, const fs::path& to) {
  std::ifstream in(from, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open() || in.bad()) throw Error(fmt::format("{}: cannot be read: {}", from.string(), std::strerror(errno)));
  write_durably(to, content);
}

void remove_leftovers(const fs::path& folder) {
  std::vector<fs::path> temporaries;
  std::error_code ignored;  // what cannot be listed or removed does no harm
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_temporary(entry.path().filename().string())) temporaries.push_back(entry.path());
  }
  for (const fs::path& file : temporaries) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove(file, ignored);
    ::close(descriptor);
  }
}

}  // namespace grainlaw
