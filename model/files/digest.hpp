#pragma once
// SHA-256, the name of content: of runs, of files, of data sets.

#include <filesystem>
#include <string>
#include <string_view>

namespace grainlaw {

std::string sha256(std::string_view bytes);                     ///< 64 lower-case hexadecimal digits
std::string sha256_bytes(std::string_view bytes);               ///< the same as 32 bytes
std::string sha256_of_file(const std::filesystem::path& file);  ///< as digits; throws Error naming the file

}  // namespace grainlaw
