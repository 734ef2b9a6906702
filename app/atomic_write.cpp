#include "app/atomic_write.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "model/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// A temporary file that disappears unless it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& final_name)
      : final_(final_name),
        name_(final_name.parent_path() / fmt::format(".{}.tmp-{}", final_name.filename().string(), getpid())) {
    // O_EXCL and O_NOFOLLOW: never write through a link that somebody placed there.
    unlink(name_.c_str());
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("be created");
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!renamed_) unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write_all(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail("be written");
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }

  void rename_to_final() {
    if (fsync(descriptor_) != 0) fail("be synced");
    const int closing = std::exchange(descriptor_, -1);
    if (close(closing) != 0) fail("be closed");
    if (std::rename(name_.c_str(), final_.c_str()) != 0) fail("be renamed into place");
    renamed_ = true;
    const fs::path folder = final_.has_parent_path() ? final_.parent_path() : fs::path(".");
    const int directory = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0) return;  // the file is whole; only its survival of a power cut is less sure
    fsync(directory);
    close(directory);
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(fmt::format("{}: cannot {}: {}", final_.string(), what, std::strerror(errno)));
  }

  fs::path final_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

}  // namespace

void write_atomically(const fs::path& file, std::string_view content) {
  TemporaryFile temporary(file);
  temporary.write_all(content);
  temporary.rename_to_final();
}

void copy_atomically(const fs::path& from, const fs::path& to) {
  std::ifstream in(from, std::ios::binary);
  if (!in) throw Error(fmt::format("{}: cannot be read: {}", from.string(), std::strerror(errno)));
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw Error(fmt::format("{}: cannot be read: {}", from.string(), std::strerror(errno)));
  write_atomically(to, content);
}

}  // namespace grainlaw::app
