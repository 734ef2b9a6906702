#pragma once
// Folders of results. Nothing is ever written outside the folder that the user named: names are checked, and a
// symbolic link below the named folder is refused rather than followed. Temporary files of killed processes are removed.

#include <filesystem>
#include <string>
#include <string_view>

namespace grainlaw {

/// 1 to 100 of letters, digits, '.', '-', '_', beginning with a letter or a digit.
bool is_safe_name(std::string_view name);

/// Creates `root` (and its parents) when absent. Throws InvalidInput when it is no folder, Error when it cannot be made.
void make_output_folder(const std::filesystem::path& root);

/// Creates root/name when absent and returns it; `name` must be safe. Throws InvalidInput for a link or a file there.
std::filesystem::path make_subfolder(const std::filesystem::path& root, const std::string& name);

}  // namespace grainlaw
