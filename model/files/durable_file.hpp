#pragma once
// Whole files only: written under a temporary name in the same folder, synced, renamed, the folder synced. Whatever goes
// wrong, a final name never holds half a file, and until the rename the earlier file under it stays as it was.

#include <filesystem>
#include <string_view>

namespace grainlaw {

/// Throws Error naming the file, the operation and the system's reason when it cannot be written whole.
void write_durably(const std::filesystem::path& file, std::string_view bytes);

/// Copies `from` to `to` in the same manner. Throws Error, also when `from` cannot be read.
void copy_durably(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes the temporary files that killed processes left in a folder; those of living ones stay.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace grainlaw
