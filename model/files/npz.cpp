#include "model/files/npz.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zip.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <memory>
#include <new>
#include <vector>

#include "model/files/csv_table.hpp"
#include "model/files/npy.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

constexpr zip_int64_t kMaxMembers = 1000;

struct Member {
  std::string name, bytes;
};

/// What libzip says of memory is nothing that is wrong with the file; where it forgets why it failed, errno, 0 before, remembers.
void throw_without_memory(const zip_error_t& error) {
  if (error.zip_err == ZIP_ER_MEMORY || errno == ENOMEM) throw std::bad_alloc();
}

class Archive {
 public:
  Archive(std::string_view bytes, const std::string& name) : name_(name) {
    zip_error_t error;
    zip_error_init(&error);
    errno = 0;
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    zip_.reset(source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error));
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    if (!zip_) {
      if (source != nullptr) zip_source_free(source);
      throw_without_memory(error);
      refuse(reason);
    }
  }

  std::vector<Member> arrays() const {
    const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > kMaxMembers) refuse(fmt::format("holds more than {} files", kMaxMembers));
    std::vector<Member> members;
    std::size_t left = kMaxForeignBytes;
    for (zip_int64_t i = 0; i < count; ++i) {
      const Member member = read(static_cast<zip_uint64_t>(i), left);
      left -= member.bytes.size();
      members.push_back(member);
    }
    return members;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InvalidInput(fmt::format(
        "{}: is no sound archive of numpy (.npz): {}; write it anew with numpy.savez, or save the sheet of a "
        "workbook (.xlsx, .ods) as CSV",
        name_, one_line(reason, 100)));
  }

  Member read(zip_uint64_t index, std::size_t most) const {
    zip_stat_t stat;
    if (zip_stat_index(zip_.get(), index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0 || stat.name == nullptr)
      refuse("a file in it has no size");
    const std::string file = stat.name;
    if (!file.ends_with(".npy")) refuse(fmt::format("'{}' is no .npy", one_line(file, 60)));
    if (stat.size > most) refuse(fmt::format("its arrays are larger than {} MB", kMaxForeignBytes >> 20));
    errno = 0;
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> in(zip_fopen_index(zip_.get(), index, 0), zip_fclose);
    if (!in) {
      throw_without_memory(*zip_get_error(zip_.get()));
      refuse(zip_strerror(zip_.get()));
    }
    Member member{file.substr(0, file.size() - 4), std::string(stat.size + 1, '\0')};
    std::size_t length = 0;
    for (;;) {  // one byte more than it says: the check of its sum comes with the end
      const zip_int64_t n = zip_fread(in.get(), member.bytes.data() + length, member.bytes.size() - length);
      if (n < 0) {
        throw_without_memory(*zip_file_get_error(in.get()));
        refuse(fmt::format("'{}' is damaged", one_line(file, 60)));
      }
      if (n == 0) break;
      length += static_cast<std::size_t>(n);
      if (length > stat.size) refuse(fmt::format("'{}' is longer than it says", one_line(file, 60)));
    }
    if (length != stat.size) refuse(fmt::format("'{}' is shorter than it says", one_line(file, 60)));
    member.bytes.resize(length);
    return member;
  }

  const std::string& name_;
  std::unique_ptr<zip_t, decltype(&zip_discard)> zip_{nullptr, zip_discard};
};

bool is_table(const NpyArray& array) { return array.shape.size() == 2 || !array.fields.front().name.empty(); }

/// The length that most 1-D arrays have; of equals the longest.
std::size_t common_length(const std::vector<std::pair<std::string, NpyArray>>& arrays) {
  std::map<std::size_t, int> count;
  for (const auto& [name, array] : arrays) {
    if (array.shape.size() == 1) ++count[array.shape.front()];
  }
  std::size_t best = 0;
  int most = 0;
  for (const auto& [length, times] : count) {
    if (times < most) continue;
    most = times;
    best = length;
  }
  return best;
}

}  // namespace

ForeignTable table_of_npz(std::string_view bytes, const std::string& name, const std::string& array) {
  const std::vector<Member> members = Archive(bytes, name).arrays();
  std::vector<std::pair<std::string, NpyArray>> arrays;
  std::vector<std::string> left_out;
  std::vector<std::string> tables;
  for (const Member& member : members) {
    if (!array.empty() && member.name != array) continue;
    try {
      arrays.emplace_back(member.name, parse_npy(member.bytes, fmt::format("{}: {}", name, one_line(member.name, 60))));
      if (is_table(arrays.back().second)) tables.push_back(member.name);
    } catch (const InvalidInput& error) {
      if (!array.empty()) throw;
      left_out.emplace_back(error.what());  // objects and texts beside the numbers
    }
  }
  if (!array.empty()) {
    if (arrays.empty())
      throw InvalidInput(fmt::format("{}: holds no array '{}'; name one that it holds", name, one_line(array, 60)));
    return table_of_npy(arrays.front().second, name);
  }
  if (tables.size() > 1)
    throw InvalidInput(
        fmt::format("{}: holds the tables {}; say with \"array\" which is meant", name, fmt::join(tables, ", ")));
  ForeignTable table;
  const std::size_t rows = common_length(arrays);
  for (const auto& [title, each] : arrays) {
    if (is_table(each)) {
      table = table_of_npy(each, name);
      break;
    }
    if (each.shape.size() != 1 || each.shape.front() != rows) continue;
    ForeignTable one = table_of_npy(each, name);
    one.columns.front().title = title;
    table.columns.push_back(std::move(one.columns.front()));
  }
  for (const auto& [title, each] : arrays) {
    const bool taken = tables.empty() ? each.shape.size() == 1 && each.shape.front() == rows : title == tables.front();
    if (!taken)
      left_out.push_back(fmt::format("{}: the array '{}' has another shape than the rows", name, one_line(title, 60)));
  }
  table.name = name;
  table.left_out = std::move(left_out);
  if (table.columns.empty())
    throw InvalidInput(
        fmt::format("{}: holds no arrays of numbers{}", name,
                    table.left_out.empty() ? "; give one for each column" : ": " + table.left_out.front()));
  if (table.columns.size() > kMaxCsvColumns)
    throw InvalidInput(fmt::format("{}: more than {} columns", name, kMaxCsvColumns));
  return table;
}

}  // namespace grainlaw
