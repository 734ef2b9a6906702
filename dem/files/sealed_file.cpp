#include "dem/files/sealed_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr std::size_t kPrefix = 16, kChecksum = 32;
constexpr std::size_t kMaxHeader = 65536;

void put_unsigned(std::string& out, std::uint64_t value, std::size_t bytes) {
  char text[8];
  for (std::size_t i = 0; i < bytes; ++i) text[i] = static_cast<char>((value >> (8 * i)) & 0xff);
  out.append(text, bytes);
}

std::uint64_t get_unsigned(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return value;
}

}  // namespace

void NumberWriter::number(double value) {
  sound_ = sound_ && std::isfinite(value);
  word(std::bit_cast<std::uint64_t>(value));
}

void NumberWriter::word(std::uint64_t value) { put_unsigned(bytes_, value, 8); }

double NumberReader::number() {
  const double value = std::bit_cast<double>(word());
  if (!std::isfinite(value)) throw InvalidInput("it holds a number that is not finite");
  return value;
}

std::uint64_t NumberReader::word() {
  if (bytes_.size() < 8) throw InvalidInput("its size contradicts its header");
  const std::uint64_t value = get_unsigned(bytes_.substr(0, 8));
  bytes_.remove_prefix(8);
  return value;
}

void write_sealed(const std::filesystem::path& file, const SealedFormat& format, const nlohmann::json& header,
                  const NumberWriter& numbers, WriteFile write) {
  const std::string text = header.dump();
  if (text.size() > kMaxHeader) throw Error(fmt::format("{}: the header is too long to be written", file.string()));
  if (!numbers.sound()) {
    throw Error(
        fmt::format("{}: is not written because a number is not finite or an array has another length", file.string()));
  }
  std::string out;
  out.reserve(kPrefix + text.size() + numbers.bytes().size() + kChecksum);
  out += format.magic;
  put_unsigned(out, format.version, 4);
  put_unsigned(out, text.size(), 4);
  out += text;
  out += numbers.bytes();
  out += sha256_bytes(out);
  write(file, out);
}

void read_sealed(const std::filesystem::path& file, const SealedFormat& format,
                 const std::function<void(const nlohmann::json& header, NumberReader& numbers)>& parse) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure))
    throw InvalidInput(fmt::format("{}: no such {}", file.string(), format.name));
  const std::string bytes = read_bytes(file);
  const auto refusal = [&](const std::string& why) {
    return InvalidInput(fmt::format("{}: {}; make it anew or give another file", file.string(), why));
  };
  if (bytes.size() < kPrefix + kChecksum || !bytes.starts_with(format.magic)) {
    throw refusal(fmt::format("is not a {}, or cut short", format.name));
  }
  const std::string_view content = std::string_view(bytes).substr(0, bytes.size() - kChecksum);
  if (sha256_bytes(content) != std::string_view(bytes).substr(content.size()))
    throw refusal("is damaged: its checksum does not fit");
  const std::uint64_t version = get_unsigned(content.substr(format.magic.size(), 4));
  if (version != format.version) {
    throw refusal(fmt::format("has format version {}, this program reads {}", version, format.version));
  }
  try {
    const std::size_t length = get_unsigned(content.substr(12, 4));
    if (length > kMaxHeader || length > content.size() - kPrefix) throw InvalidInput("its header is too long");
    const auto header = nlohmann::json::parse(content.substr(kPrefix, length), nullptr, false);
    if (header.is_discarded() || !header.is_object()) throw InvalidInput("its header is not JSON");
    NumberReader numbers(content.substr(kPrefix + length));
    if ((content.size() - kPrefix - length) % 8 != 0) throw InvalidInput("its size contradicts its header");
    parse(header, numbers);
    if (numbers.words_left() != 0) throw InvalidInput("its size contradicts its header");
  } catch (const InvalidInput& why) {
    throw refusal(why.what());
  } catch (const nlohmann::json::exception& why) {
    throw refusal(fmt::format("its header is not understood ({})", why.what()));
  }
}

}  // namespace grainlaw::dem
