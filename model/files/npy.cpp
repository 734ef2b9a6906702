#include "model/files/npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>

#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

constexpr std::size_t kMaxHeader = 1u << 20;
constexpr std::size_t kMaxDimensions = 32;

/// The header's text, a Python literal, read from front to back.
class Header {
 public:
  Header(std::string_view text, const std::string& name, NpyArray& array) : left_(text), name_(name), array_(array) {}

  void read() {
    bool descr = false, order = false, shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = word();
      expect(':');
      if (key == "descr" && !descr) {
        read_descr();
        descr = true;
      } else if (key == "fortran_order" && !order) {
        array_.fortran_order = truth();
        order = true;
      } else if (key == "shape" && !shape) {
        read_shape();
        shape = true;
      } else {
        refuse(fmt::format("has the key '{}'", one_line(key, 40)));
      }
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    if (!descr || !order || !shape) refuse("misses descr, fortran_order or shape");
    blanks();
    if (!left_.empty()) refuse("goes on after its end");
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput(fmt::format("{}: the header of the array {}; write it anew with numpy.save", name_, why));
  }

  void blanks() {
    while (!left_.empty() && (left_.front() == ' ' || left_.front() == '\n')) left_.remove_prefix(1);
  }
  bool take(char c) {
    blanks();
    if (left_.empty() || left_.front() != c) return false;
    left_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) refuse(fmt::format("misses '{}'", c));
  }
  std::string word() {
    blanks();
    const char quote = left_.empty() ? ' ' : left_.front();
    if (quote != '\'' && quote != '"') refuse("misses a quoted word");
    const auto end = left_.find(quote, 1);
    if (end == std::string_view::npos || left_.substr(0, end).find('\\') != std::string_view::npos)
      refuse("has a word that does not end, or a backslash");
    std::string text(left_.substr(1, end - 1));
    left_.remove_prefix(end + 1);
    return text;
  }
  bool truth() {
    blanks();
    for (const std::string_view value : {"True", "False"}) {
      if (!left_.starts_with(value)) continue;
      left_.remove_prefix(value.size());
      return value == "True";
    }
    refuse("has a fortran_order that is neither True nor False");
  }
  std::size_t number() {
    blanks();
    std::uint64_t value = 0;
    const auto [rest, code] = std::from_chars(left_.data(), left_.data() + left_.size(), value);
    if (code != std::errc{} || value > kMaxForeignBytes) refuse("has a length that is none, or is beyond what is read");
    left_.remove_prefix(static_cast<std::size_t>(rest - left_.data()));
    return value;
  }

  void read_shape() {
    expect('(');
    while (!take(')')) {
      if (array_.shape.size() == kMaxDimensions) refuse("has too many dimensions");
      array_.shape.push_back(number());
      if (!take(',')) {
        expect(')');
        break;
      }
    }
  }

  void add_field(const std::string& field, const std::string& type) {
    const bool known = type.size() == 3 && (type[0] == '<' || type[0] == '>') && (type[1] == 'f' || type[1] == 'i') &&
                       (type[2] == '4' || type[2] == '8');
    if (!known)
      refuse(
          fmt::format("has {}the type '{}', where only numbers f4, f8, i4, i8 of byte order < or > are read (objects "
                      "are pickled and never are)",
                      field.empty() ? "" : fmt::format("for '{}' ", one_line(field, 40)), one_line(type, 20)));
    if (array_.fields.size() == kMaxCsvColumns) refuse(fmt::format("has more than {} fields", kMaxCsvColumns));
    array_.fields.push_back(
        {field, type[1], static_cast<std::size_t>(type[2] - '0'), type[0] == '>', array_.item_size()});
  }

  void read_descr() {
    if (!take('[')) return add_field("", word());
    while (!take(']')) {
      expect('(');
      const std::string field = word();
      expect(',');
      if (field.empty()) refuse("has a field without a name");
      add_field(field, word());
      take(',');
      expect(')');
      if (!take(',')) {
        expect(']');
        break;
      }
    }
    if (array_.fields.empty()) refuse("has no fields");
  }

  std::string_view left_;
  const std::string& name_;
  NpyArray& array_;
};

std::size_t little_endian(std::string_view bytes) {
  std::size_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

template <class Bits, class Float>
double decoded(std::string_view bytes, const NpyField& field) {
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(Bits); ++i) {
    const auto byte = static_cast<unsigned char>(bytes[field.big_endian ? i : sizeof(Bits) - 1 - i]);
    bits = static_cast<Bits>(bits << 8 | byte);
  }
  if (field.kind == 'f') return static_cast<double>(std::bit_cast<Float>(bits));
  return static_cast<double>(static_cast<std::make_signed_t<Bits>>(bits));
}

}  // namespace

std::size_t NpyArray::items() const {
  std::size_t product = 1;
  for (const std::size_t n : shape) {
    if (n != 0 && product > kMaxForeignBytes / n) return kMaxForeignBytes + 1;  // more than any file here holds
    product *= n;
  }
  return product;
}

std::size_t NpyArray::item_size() const { return fields.empty() ? 0 : fields.back().offset + fields.back().size; }

double NpyArray::number(std::size_t item, const NpyField& field) const {
  const std::string_view bytes = data.substr(item * item_size() + field.offset, field.size);
  return field.size == 4 ? decoded<std::uint32_t, float>(bytes, field) : decoded<std::uint64_t, double>(bytes, field);
}

NpyArray parse_npy(std::string_view bytes, const std::string& name) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput(fmt::format("{}: {}", name, why)); };
  if (!bytes.starts_with(kNpyMagic) || bytes.size() < 12) refuse("is no array of numpy, or ends within its header");
  const int version = bytes[6];
  if (version < 1 || version > 3) refuse(fmt::format("is of version {} of numpy's format; save it as 1.0", version));
  const std::size_t start = version == 1 ? 10 : 12, length = little_endian(bytes.substr(8, start - 8));
  if (length > kMaxHeader || start + length > bytes.size()) refuse("ends within its header");
  NpyArray array;
  Header(bytes.substr(start, length), name, array).read();
  array.data = bytes.substr(start + length);
  const std::size_t items = array.items();
  if (items > kMaxForeignBytes || items * array.item_size() != array.data.size())
    refuse(fmt::format("holds {} bytes where its header says {} items of {}; it was cut off or changed",
                       array.data.size(), items > kMaxForeignBytes ? "too many" : std::to_string(items),
                       array.item_size()));
  return array;
}

ForeignTable table_of_npy(const NpyArray& array, const std::string& name) {
  ForeignTable table;
  table.name = name;
  const bool records = !array.fields.front().name.empty();
  if (array.shape.empty() || array.shape.size() > (records ? 1u : 2u))
    throw InvalidInput(
        fmt::format("{}: is an array of {} dimensions{}; give one row for each instant and one column for each "
                    "quantity",
                    name, array.shape.size(), records ? " of records" : ""));
  const std::size_t rows = array.shape.front(), width = array.shape.size() == 2 ? array.shape[1] : 1;
  if (width > kMaxCsvColumns) throw InvalidInput(fmt::format("{}: more than {} columns", name, kMaxCsvColumns));
  for (std::size_t k = 0; k < (records ? array.fields.size() : width); ++k) {
    const NpyField& field = array.fields[records ? k : 0];
    ForeignColumn column{records ? field.name : std::to_string(k + 1), std::vector<double>(rows), 0, ""};
    for (std::size_t i = 0; i < rows; ++i) {
      const std::size_t item = records ? i : array.fortran_order ? k * rows + i : i * width + k;
      column.values[i] = array.number(item, field);
    }
    table.columns.push_back(std::move(column));
  }
  return table;
}

}  // namespace grainlaw
