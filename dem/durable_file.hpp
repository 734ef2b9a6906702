#pragma once
// Writing a file so that its name never holds half of it: temporary name in the same folder, fsync, rename, fsync of
// the folder. Whatever goes wrong, the earlier file under the name stays.

#include <filesystem>
#include <string_view>

namespace grainlaw::dem {

/// Throws Error naming the file and the system's reason when it cannot be written whole.
void write_durably(const std::filesystem::path& file, std::string_view bytes);

}  // namespace grainlaw::dem
