#pragma once
// The envelope of the engine's binary files; integers and doubles little-endian:
//   magic, 8 bytes | version u32 | length of the header u32 | header, JSON | numbers, 8 bytes each | SHA-256 of all before
// Written as model/files/output.hpp says. Read: checksum first, then everything else.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "model/files/output.hpp"

namespace grainlaw::dem {

struct SealedFormat {
  std::string_view magic;  ///< 8 characters
  std::uint32_t version;   ///< grows with every change of the layout
  std::string_view name;   ///< for messages, e.g. "state file"
};

/// Collects numbers for a file.
class NumberWriter {
 public:
  void number(double value);
  void word(std::uint64_t value);
  void reserve(std::size_t words) { bytes_.reserve(8 * words); }
  void refuse() { sound_ = false; }      ///< what was collected contradicts itself
  bool sound() const { return sound_; }  ///< every number was finite and nothing was refused
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  bool sound_ = true;
};

/// Hands out the numbers of a file one after the other.
class NumberReader {
 public:
  explicit NumberReader(std::string_view bytes) : bytes_(bytes) {}
  double number();       ///< throws InvalidInput unless finite
  std::uint64_t word();  ///< throws InvalidInput at the end
  std::size_t words_left() const { return bytes_.size() / 8; }

 private:
  std::string_view bytes_;
};

/// How a file is written: write_durably or write_whole.
using WriteFile = void (*)(const std::filesystem::path& file, std::string_view bytes);

/// Throws Error naming the file when it cannot be written whole or the numbers are not sound; the earlier file stays.
void write_sealed(const std::filesystem::path& file, const SealedFormat& format, const nlohmann::json& header,
                  const NumberWriter& numbers, WriteFile write = write_durably);

/// Calls parse with header and numbers. Throws InvalidInput naming file and reason: missing, damaged, other version, or
/// what parse threw (InvalidInput or an exception of the JSON library).
void read_sealed(const std::filesystem::path& file, const SealedFormat& format,
                 const std::function<void(const nlohmann::json& header, NumberReader& numbers)>& parse);

}  // namespace grainlaw::dem
