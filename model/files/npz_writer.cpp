#include "model/files/npz_writer.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <bit>
#include <cstdlib>

#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Magic, version, length of the head, the head as a Python dict padded to 64 bytes, the numbers.
std::string npy_bytes(const NamedArray& array) {
  const bool real = array.values.index() == 0;
  std::string shape;
  for (const std::size_t length : array.shape) shape += fmt::format("{},", length);
  std::string head =
      fmt::format("{{'descr': '<{}8', 'fortran_order': False, 'shape': ({}), }}", real ? 'f' : 'i', shape);
  head.append(63 - (10 + head.size()) % 64, ' ');
  head += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(head.size() & 0xff);
  bytes += static_cast<char>(head.size() >> 8);
  bytes += head;
  std::visit(
      [&](const auto& values) {
        bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
      },
      array.values);
  return bytes;
}

[[noreturn]] void fail(const std::string& file, zip_t* zip) {
  const int code = zip == nullptr ? ZIP_ER_MEMORY : zip_error_code_zip(zip_get_error(zip));
  const bool memory = code == ZIP_ER_MEMORY || code == ZIP_ER_OK;  // not all that fails for it says so
  const std::string reason = memory ? "no memory" : zip_error_strerror(zip_get_error(zip));
  if (zip != nullptr) zip_discard(zip);
  throw Error(fmt::format("{}: cannot be made: {}", file, reason));
}

}  // namespace

void write_npz(const std::filesystem::path& file, const std::vector<NamedArray>& arrays) {
  std::vector<std::string> contents;
  for (const NamedArray& array : arrays) contents.push_back(npy_bytes(array));
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* archive = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (archive == nullptr) fail(file.string(), nullptr);
  zip_source_keep(archive);  // to be read after the archive is closed
  zip_t* zip = zip_open_from_source(archive, ZIP_TRUNCATE, &error);
  if (zip == nullptr) fail(file.string(), nullptr);
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    zip_source_t* source = zip_source_buffer(zip, contents[i].data(), contents[i].size(), 0);
    if (source == nullptr) fail(file.string(), zip);
    const zip_int64_t index = zip_file_add(zip, (arrays[i].name + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      fail(file.string(), zip);
    }
    zip_file_set_mtime(zip, static_cast<zip_uint64_t>(index), 315532800, 0);  // 1980: the same bytes every time
  }
  if (zip_close(zip) != 0) fail(file.string(), zip);
  zip_stat_t stat;
  zip_source_stat(archive, &stat);
  std::string bytes(stat.size, '\0');
  const bool read = zip_source_open(archive) == 0 &&
                    zip_source_read(archive, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size());
  zip_source_close(archive);
  zip_source_free(archive);
  if (!read) throw Error(fmt::format("{}: cannot be made: the archive cannot be read back", file.string()));
  write_durably(file, bytes);
}

}  // namespace grainlaw
