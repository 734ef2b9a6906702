#include "model/files/reading.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

bool is_of_the_file(int error) {
  return error == ENOENT || error == ENOTDIR || error == EISDIR || error == EACCES || error == EPERM ||
         error == ELOOP || error == ENAMETOOLONG;
}

}  // namespace

void fail_to_read(const std::string& name, const char* what, std::string_view remedy) {
  const int error = errno;
  const std::string text =
      fmt::format("{}: cannot be {}: {}{}{}", name, what, std::strerror(error), remedy.empty() ? "" : "; ", remedy);
  if (is_of_the_file(error)) throw InvalidInput(text);
  throw Error(text);
}

std::string read_bytes(const std::filesystem::path& file, std::string_view remedy, std::size_t most,
                       std::string_view too_large) {
  const std::string name = one_line(file.string(), 200);
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> in(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!in) fail_to_read(name, "opened", remedy);
  const auto check_size = [&](std::size_t size) {
    if (size > most) throw InvalidInput(fmt::format("{}: is larger than {} MB; {}", name, most >> 20, too_large));
  };
  struct stat status {};
  std::string bytes;
  if (fstat(fileno(in.get()), &status) == 0 && S_ISREG(status.st_mode)) {
    check_size(static_cast<std::size_t>(status.st_size));
    bytes.reserve(static_cast<std::size_t>(status.st_size));
  }
  std::string buffer(1 << 16, '\0');
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), in.get())) {
    bytes.append(buffer, 0, n);
    check_size(bytes.size());
  }
  if (std::ferror(in.get())) fail_to_read(name, "read");
  return bytes;
}

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  std::error_code error;
  std::filesystem::directory_iterator it(folder, error);
  for (; !error && it != std::filesystem::directory_iterator(); it.increment(error)) entries.push_back(it->path());
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory) {
    errno = error.value();
    fail_to_read(one_line(folder.string(), 200), "listed");
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace grainlaw
