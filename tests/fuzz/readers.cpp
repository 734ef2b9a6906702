#include "tests/fuzz/readers.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "model/files/digest.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fuzz {
namespace {

constexpr std::size_t kChecksum = 32, kLongestMessage = 2000;

void put(const std::filesystem::path& file, std::string_view bytes) {
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const bool whole = out >= 0 && ::write(out, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  if (out < 0 || ::close(out) != 0 || !whole) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

void check_message(const std::string& message, const std::string& name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  const bool named = message.find(name) != std::string::npos || message.starts_with('/');  // a file that the bytes name
  const char* fault = !named                                                    ? "does not name the file"
                      : std::any_of(message.begin(), message.end(), is_control) ? "is not one line of text"
                      : message.size() > kLongestMessage                        ? "is too long"
                                                                                : nullptr;
  if (fault != nullptr) throw Finding(fmt::format("a refusal {}: {}", fault, one_line(message, 400)));
}

bool accepts(const Reader& reader, std::string_view bytes) {
  std::string sealed;
  if (reader.shape == Shape::sealed) bytes = sealed = std::string(bytes) + sha256_bytes(bytes);
  if (!reader.file.empty()) put(reader.file, bytes);
  try {
    reader.read(bytes, reader.file);
    return true;
  } catch (const Error& refusal) {
    check_message(refusal.what(), reader.file.empty() ? "bytes" : std::filesystem::path(reader.file).parent_path());
    return false;
  }
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> seeds(const Reader& reader, const std::filesystem::path& scene) {
  std::vector<std::string> all;
  if (!reader.file.empty()) all.push_back(content(reader.file));
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(scene / "seeds" / reader.name, none))
    all.push_back(content(entry.path()));
  for (std::string& bytes : all) bytes.resize(bytes.size() - (reader.shape == Shape::sealed ? kChecksum : 0));
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Reader> readers(const std::filesystem::path& scene) {
  std::vector<Reader> all;
  for (const auto& room : {readers_of_model, readers_of_dem, readers_of_imports, readers_of_the_law}) {
    for (Reader& reader : room(scene)) {
      if (!reader.file.empty()) reader.file = scene / reader.file;
      all.push_back(std::move(reader));
    }
  }
  return all;
}

void check_round_trip(const std::function<std::string()>& write,
                      const std::function<std::string(const std::string& text)>& again) {
  try {
    const std::string text = write(), back = again(text);
    if (text == back) return;
    const auto at = std::mismatch(text.begin(), text.end(), back.begin(), back.end()).first - text.begin();
    const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - 40));
    throw Finding(fmt::format("reads back otherwise: {} for {}",
                              one_line(back.substr(std::min(from, back.size())), 120),
                              one_line(text.substr(from), 120)));
  } catch (const Error& error) {
    throw Finding(fmt::format("what was accepted cannot be written and read: {}", error.what()));
  }
}

}  // namespace grainlaw::fuzz
