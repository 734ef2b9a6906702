#pragma once
// JSON in and out. Reading is strict and bounded: size, nesting (while parsing), UTF-8, duplicate keys, numbers that no
// double holds, byte order marks and negative zero are refused with file and key in one line. Writing never writes a
// non-finite number; an undefined quantity (NaN) becomes null.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace grainlaw {

using Json = nlohmann::json;  ///< keys sorted: dump() is the canonical form that digests are taken of
/// Keys in the order of writing: what files are written from. Begins as OrderedJson::object() or array(): version 3.11.2 cannot
/// destroy a null that was about to become one when memory ran out.
using OrderedJson = nlohmann::ordered_json;

inline constexpr std::size_t kMaxJsonBytes = 64u << 20;  ///< larger documents are refused before parsing [byte]
inline constexpr int kMaxJsonDepth = 32;                 ///< deeper nesting is refused while parsing

enum class JsonSource {
  user,  ///< 2000.0 and 2e3 count as the integer 2000; -0 is refused; comments (//, /* */) are skipped
  own,   ///< numbers exactly as written by write_json
  any,   ///< of whoever made it: as of a user, but -0 stands
};

/// `name` stands for the document in messages. Throws InvalidInput.
Json parse_json(std::string_view text, const std::string& name, JsonSource source);

/// Throws InvalidInput naming the file when it is not there or cannot be parsed, Error when the system fails to read it.
Json read_json(const std::filesystem::path& file, JsonSource source);

/// Two spaces of indentation, arrays of plain values on one line. Throws Error naming the key of a non-finite number.
std::string json_text(const OrderedJson& document);

/// json_text() in a durably written file.
void write_json(const std::filesystem::path& file, const OrderedJson& document);

/// null for NaN, the number otherwise.
OrderedJson number_or_null(double value);
/// NaN for null, the number otherwise.
double number_or_nan(const Json& value);

}  // namespace grainlaw
