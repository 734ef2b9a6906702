#include "dem/durable_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "model/error.hpp"

namespace grainlaw::dem {
namespace {

/// An open file that closes itself.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

void write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      throw std::system_error(errno, std::generic_category());
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void must(int result) {
  if (result < 0) throw std::system_error(errno, std::generic_category());
}

std::filesystem::path temporary_name(const std::filesystem::path& file) {
  static std::atomic<unsigned> count{0};  // two threads may write at a time
  std::filesystem::path name = file;
  name += fmt::format(".tmp-{}-{}", ::getpid(), count++);
  return name;
}

}  // namespace

void write_durably(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path temporary = temporary_name(file);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  try {
    Descriptor out{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666)};
    must(out.number);
    write_all(out.number, bytes);
    must(::fsync(out.number));
    // some file systems report a failed write only here
    must(::close(std::exchange(out.number, -1)));
    std::filesystem::rename(temporary, file);
    Descriptor parent{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    must(parent.number);
    // EINVAL: a file system that cannot sync folders has nothing to sync
    if (::fsync(parent.number) < 0 && errno != EINVAL) throw std::system_error(errno, std::generic_category());
  } catch (const std::system_error& failure) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(fmt::format("{}: cannot be written ({}); check space and permissions", file.string(),
                            failure.code().message()));
  }
}

}  // namespace grainlaw::dem
