#include "model/files/one_line.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace grainlaw {
namespace {

/// The code point that begins at `at` and its length in bytes; length 0 where the bytes are no UTF-8.
struct CodePoint {
  std::uint32_t value = 0;
  std::size_t length = 0;
};
CodePoint code_point(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
  if (length == 0 || at + length > text.size()) return {};
  std::uint32_t value = length == 1 ? first : first & (0x7fu >> length);
  for (std::size_t i = at + 1; i < at + length; ++i) {
    if (byte(i) >> 6 != 2) return {};
    value = value << 6 | (byte(i) & 0x3fu);
  }
  return {value, length};
}

/// What moves a terminal's cursor, ends a line or turns the direction of the text around.
bool steers(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x61c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;
}

}  // namespace

std::string one_line(std::string_view text, std::size_t limit) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    if (line.size() >= limit) {
      line += "...";
      break;
    }
    const auto [c, length] = code_point(text, at);
    if (length == 0 || c < 0x80) {
      const auto byte = static_cast<unsigned char>(text[at]);
      line += length == 0 || steers(c) ? fmt::format("\\x{:02x}", byte) : std::string(1, text[at]);
    } else {
      line += steers(c) ? fmt::format("\\u{:04x}", c) : std::string(text.substr(at, length));
    }
    at += length == 0 ? 1 : length;
  }
  return line;
}

}  // namespace grainlaw
