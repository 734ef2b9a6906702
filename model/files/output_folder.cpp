#include "model/files/output_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/files/durable_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {

namespace fs = std::filesystem;

bool is_safe_name(std::string_view name) {
  const auto alphanumeric = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  return !name.empty() && name.size() <= 100 && alphanumeric(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return alphanumeric(c) || c == '.' || c == '-' || c == '_'; });
}

void make_output_folder(const fs::path& root) {
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
