#include "model/files/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "model/files/reading.hpp"
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

/// Whether a name is one that temporary_name() gives, to `file` if that is not empty.
bool is_temporary(const std::string& name, const std::string& file) {
  return file.empty() ? name.starts_with('.') && name.find(kMark) != std::string::npos
                      : name.starts_with("." + file + std::string(kMark));
}

[[noreturn]] void fail_at(const fs::path& file, const char* what) {
  throw Error(
      fmt::format("{}: cannot be {} ({}); check space and permissions", file.string(), what, std::strerror(errno)));
}

/// False with errno set when not everything could be written.
bool write_to(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void write_into(const fs::path& file, int descriptor, std::string_view bytes) {
  if (descriptor < 0) fail_at(file, "opened");
  const bool written = write_to(descriptor, bytes);
  const int error = errno;
  ::close(descriptor);
  errno = error;
  if (!written) fail_at(file, "written");
}

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
    if (!write_to(descriptor_, bytes)) fail("written");
  }

  void rename_to_final(bool synced) {
    if (synced && ::fsync(descriptor_) != 0) fail("synced");
    // some file systems report a failed write only here
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("closed");
    if (std::rename(name_.c_str(), final_.c_str()) != 0) fail("renamed into place");
    renamed_ = true;
    if (!synced) return;
    const int folder = ::open(folder_of(final_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) fail("synced");
    // EINVAL: a file system that cannot sync folders has nothing to sync
    const int error = ::fsync(folder) != 0 && errno != EINVAL ? errno : 0;
    ::close(folder);
    errno = error;
    if (error != 0) fail("synced");
  }

 private:
  [[noreturn]] void fail(const char* what) const { fail_at(final_, what); }

  fs::path final_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Names that Windows keeps for devices, with any extension: a folder of results may go to a drive of its own.
bool is_device(std::string_view name) {
  std::string stem(name.substr(0, name.find('.')));
  for (char& c : stem) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  if (stem.size() == 4 && (stem.starts_with("COM") || stem.starts_with("LPT"))) return stem[3] >= '1' && stem[3] <= '9';
  return stem == "CON" || stem == "PRN" || stem == "AUX" || stem == "NUL";
}

}  // namespace

void write_durably(const fs::path& file, std::string_view bytes) {
  TemporaryFile temporary(file);
  temporary.write_all(bytes);
  temporary.rename_to_final(true);
}

void write_whole(const fs::path& file, std::string_view bytes) {
  TemporaryFile temporary(file);
  temporary.write_all(bytes);
  temporary.rename_to_final(false);
}

void link_or_copy(const fs::path& from, const fs::path& to) {
  const std::string temporary = temporary_name(to);
  ::unlink(temporary.c_str());
  if (::link(from.c_str(), temporary.c_str()) != 0) return copy_whole(from, to);
  const bool renamed = std::rename(temporary.c_str(), to.c_str()) == 0;
  const int error = errno;
  ::unlink(temporary.c_str());  // still there where both names are this file's already
  errno = error;
  if (!renamed) fail_at(to, "renamed into place");
}

void sync_files_below(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::syncfs(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  errno = error;
  if (!synced) fail_at(folder, "synced");
}

void write_as_named(const fs::path& file, std::string_view bytes) {
  if (file == "-") return write_into("standard output", ::dup(STDOUT_FILENO), bytes);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);  // of a link's target
  if (fs::is_directory(status)) throw InvalidInput(fmt::format("{}: is a folder; name a file in it", file.string()));
  if (fs::exists(status) && !fs::is_regular_file(status))
    return write_into(file, ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY), bytes);
  fs::path target = file;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, error)); ++links) {
    const fs::path to = fs::read_symlink(target, error);
    if (error || links == 40) throw Error(fmt::format("{}: is a link that leads nowhere; remove it", file.string()));
    target = folder_of(target) / to;
  }
  remove_leftovers(folder_of(target), target.filename().string());
  write_durably(target, bytes);
}

void copy_durably(const fs::path& from, const fs::path& to) { write_durably(to, read_bytes(from)); }

void copy_whole(const fs::path& from, const fs::path& to) { write_whole(to, read_bytes(from)); }

void remove_leftovers(const fs::path& folder, const std::string& file_name) {
  std::vector<fs::path> temporaries;
  std::error_code ignored;  // what cannot be listed or removed does no harm
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_temporary(entry.path().filename().string(), file_name)) temporaries.push_back(entry.path());
  }
  for (const fs::path& file : temporaries) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove(file, ignored);
    ::close(descriptor);
  }
}

bool is_safe_name(std::string_view name) {
  const auto alphanumeric = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  return !name.empty() && name.size() <= 100 && alphanumeric(name.front()) && name.back() != '.' && !is_device(name) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return alphanumeric(c) || c == '.' || c == '-' || c == '_'; });
}

void make_output_folder(const fs::path& root) {
  if (root == "-") throw InvalidInput("-: standard output is no folder; give another -o, ./- for one of that name");
  std::error_code error;
  const fs::file_status status = fs::status(root, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InvalidInput(fmt::format("{}: is not a folder; give another -o", root.string()));
  }
  fs::create_directories(root, error);
  if (error) throw Error(fmt::format("{}: cannot be created: {}", root.string(), error.message()));
  remove_leftovers(root);
}

fs::path make_subfolder(const fs::path& root, const std::string& name) {
  if (!is_safe_name(name)) {
    throw InvalidInput(fmt::format("'{}' is no name for a folder; use letters, digits, '.', '-' and '_'", name));
  }
  const fs::path folder = root / name;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder, error);
  if (fs::is_symlink(status)) {
    throw InvalidInput(
        fmt::format("{}: is a symbolic link and would lead out of the output folder; remove it", folder.string()));
  }
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InvalidInput(fmt::format("{}: is a file where a folder is needed; remove it", folder.string()));
  }
  fs::create_directory(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
  remove_leftovers(folder);
  return folder;
}

}  // namespace grainlaw
