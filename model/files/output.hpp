#pragma once
// Files and folders of results. Whole files only: written under a temporary name in the same folder, synced, renamed,
// the folder synced. Whatever goes wrong, a final name never holds half a file, and until the rename the earlier file
// under it stays as it was. Nothing is ever written outside the folder that the user named: names are checked, and a
// symbolic link below that folder is refused rather than followed.

#include <filesystem>
#include <string>
#include <string_view>

namespace grainlaw {

/// Throws Error naming the file, the operation and the system's reason when it cannot be written whole.
void write_durably(const std::filesystem::path& file, std::string_view bytes);

/// Copies `from` to `to` in the same manner. Throws Error, also when `from` cannot be read.
void copy_durably(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes the temporary files that killed processes left in a folder; those of living ones stay.
void remove_leftovers(const std::filesystem::path& folder);

/// 1 to 100 of letters, digits, '.', '-', '_', beginning with a letter or a digit.
bool is_safe_name(std::string_view name);

/// Creates `root` (and its parents) when absent and removes the leftovers in it. Throws InvalidInput when it is no
/// folder, Error when it cannot be made.
void make_output_folder(const std::filesystem::path& root);

/// Likewise root/name, which it returns; `name` must be safe. Throws InvalidInput for a link or a file there.
std::filesystem::path make_subfolder(const std::filesystem::path& root, const std::string& name);

}  // namespace grainlaw
