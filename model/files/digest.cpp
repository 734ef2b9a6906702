#include "model/files/digest.hpp"

#include <fmt/format.h>
#define OPENSSL_SUPPRESS_DEPRECATED  // of SHA256_...; EVP takes memory, and reads from address 0 where there is none
#include <openssl/sha.h>

#include <array>
#include <cstdio>
#include <memory>

#include "model/files/reading.hpp"

namespace grainlaw {
namespace {

class Sha256 {
 public:
  Sha256() { SHA256_Init(&context_); }
  void add(std::string_view bytes) { SHA256_Update(&context_, bytes.data(), bytes.size()); }
  std::string bytes() {
    std::string digest(SHA256_DIGEST_LENGTH, '\0');
    SHA256_Final(reinterpret_cast<unsigned char*>(digest.data()), &context_);
    return digest;
  }

 private:
  SHA256_CTX context_{};
};

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

}  // namespace

std::string sha256_bytes(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.bytes();
}

std::string sha256(std::string_view bytes) { return hex(sha256_bytes(bytes)); }

std::string sha256_of_file(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> in(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!in) fail_to_read(file.string(), "read");
  Sha256 sum;
  std::array<char, 1 << 16> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), in.get())) sum.add({buffer.data(), n});
  if (std::ferror(in.get())) fail_to_read(file.string(), "read");
  return hex(sum.bytes());
}

}  // namespace grainlaw
