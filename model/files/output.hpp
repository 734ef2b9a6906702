#pragma once
// Files and folders of results. Whole files only: written under a temporary name in the same folder, synced, renamed,
// the folder synced. Whatever goes wrong, a final name never holds half a file, and until the rename the earlier file
// under it stays as it was. Nothing is ever written outside the folder that the user named: names are checked, and a
// symbolic link below that folder is refused rather than followed.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw {

/// Throws Error naming the file, the operation and the system's reason when it cannot be written whole.
void write_durably(const std::filesystem::path& file, std::string_view bytes);

/// As write_durably(), but not synced, which is most of the time where there are many: the death of the program leaves it whole, that
/// of the machine may damage it until sync_files_below().
void write_whole(const std::filesystem::path& file, std::string_view bytes);

/// Copies likewise. Throws Error, also when `from` cannot be read.
void copy_whole(const std::filesystem::path& from, const std::filesystem::path& to);

/// A second name for the file, where the file system has such; else a copy. What is written by the functions here later replaces one
/// of the two and leaves the other. Throws Error, also when `from` cannot be read.
void link_or_copy(const std::filesystem::path& from, const std::filesystem::path& to);

/// All that was written into the file system of `folder` is on the disk. Throws Error.
void sync_files_below(const std::filesystem::path& folder);

/// A file of the user's own choice, outside a folder of results: through a link its target is written, durably; a device, a FIFO or
/// a socket is written into, never replaced; "-" is standard output. Throws Error likewise, InvalidInput for a folder.
void write_as_named(const std::filesystem::path& file, std::string_view bytes);

/// Copies `from` to `to` in the same manner. Throws Error, also when `from` cannot be read.
void copy_durably(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes the temporary files that killed processes left in a folder; those of living ones stay. `file`: only those of a file of
/// that name, where the folder is the user's.
void remove_leftovers(const std::filesystem::path& folder, const std::string& file = "");

/// 1 to 100 of letters, digits, '.', '-', '_', beginning with a letter or a digit, not ending with '.', and no device of Windows
/// (CON, nul.csv).
bool is_safe_name(std::string_view name);

/// Creates `root` (and its parents) when absent and removes the leftovers in it. Throws InvalidInput when it is no
/// folder or "-", Error when it cannot be made.
void make_output_folder(const std::filesystem::path& root);

/// Likewise root/name, which it returns; `name` must be safe. Throws InvalidInput for a link or a file there.
std::filesystem::path make_subfolder(const std::filesystem::path& root, const std::string& name);

/// What `work` returns. When it throws, those of `folders` that are empty are removed, in this order.
template <class Work>
auto without_empty_folders(const std::vector<std::filesystem::path>& folders, const Work& work) {
  try {
    return work();
  } catch (...) {
    std::error_code not_empty;  // then it stays
    for (const std::filesystem::path& folder : folders) std::filesystem::remove(folder, not_empty);
    throw;
  }
}

}  // namespace grainlaw
