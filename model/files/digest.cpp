#include "model/files/digest.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cstdio>
#include <memory>

#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    need(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void add(std::string_view bytes) { need(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1); }
  std::string bytes() {
    std::string digest(32, '\0');
    need(EVP_DigestFinal_ex(context_.get(), reinterpret_cast<unsigned char*>(digest.data()), nullptr) == 1);
    return digest;
  }

 private:
  static void need(bool success) {
    if (!success) throw Error("SHA-256: OpenSSL has no memory, or is installed without it");
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
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
