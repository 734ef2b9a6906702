#pragma once
// Whole files only: written under a temporary name beside the final one, synced, renamed. A failure leaves the earlier
// file under the final name as it was and no temporary file behind.

#include <filesystem>
#include <string_view>

namespace grainlaw::app {

/// Throws Error naming `file` and the system's reason.
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// Copies `from` to `to` in the same manner.
void copy_atomically(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace grainlaw::app
