#pragma once
// Files that cannot be read: what another file would help against, and what the system fails at for now. The latter must not pass
// for damage: nobody throws a finished run away because too many files were open.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw {

/// Of a call that failed with errno: "NAME: cannot be WHAT: REASON; REMEDY". Throws InvalidInput where there is no such file, or none
/// that may be read, Error for all other reasons.
[[noreturn]] void fail_to_read(const std::string& name, const char* what, std::string_view remedy = {});

/// All bytes of a file. Throws as fail_to_read() does, with `remedy` where it cannot be opened; InvalidInput for more than `most`
/// bytes, "NAME: is larger than N MB; TOO_LARGE", unread where its size is known.
std::string read_bytes(const std::filesystem::path& file, std::string_view remedy = {},
                       std::size_t most = std::numeric_limits<std::size_t>::max(), std::string_view too_large = {});

/// What is in a folder, sorted; nothing where there is no such folder. Throws as fail_to_read() does.
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

}  // namespace grainlaw
