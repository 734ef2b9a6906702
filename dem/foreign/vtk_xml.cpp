// XML files of VTK: points of PolyData (.vtp) or of an UnstructuredGrid (.vtu) with their arrays; text, base64 or appended,
// compressed by zlib or not. Of the field data, TimeValue and an array "cell" (H row by row) are taken.
//   binary array:  [bytes][data], or compressed [blocks][block size][last block's size][compressed sizes...][blocks...]

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <pugixml.hpp>
#include <string>

#include "dem/foreign/foreign_frame.hpp"
#include "model/files/reading.hpp"

namespace grainlaw::dem {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kMostInflated = 1100;  // zlib makes no byte of more than 1032

/// Hands out the bytes of an array: as they are, or from base64 by groups of four, so that a header may have its own padding.
class Bytes {
 public:
  Bytes(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /// Nothing when fewer are left.
  bool take(std::size_t count, std::string& out) {
    if (!base64_) {
      if (text_.size() < count) return false;
      out.assign(text_.substr(0, count));
      text_.remove_prefix(count);
      return true;
    }
    if (count > most_left()) return false;
    while (decoded_.size() < count) {
      if (!decode_group()) return false;
    }
    out = decoded_.substr(0, count);
    decoded_.erase(0, count);
    return true;
  }

  std::size_t most_left() const { return base64_ ? text_.size() / 4 * 3 + decoded_.size() + 3 : text_.size(); }

 private:
  static int value_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  bool decode_group() {
    std::uint32_t bits = 0;
    int characters = 0, padding = 0;
    while (characters < 4) {
      if (text_.empty()) return false;
      const char c = text_.front();
      text_.remove_prefix(1);
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      const int value = c == '=' ? 0 : value_of(c);
      if (value < 0 || (c != '=' && padding > 0)) return false;
      padding += c == '=';
      bits = bits << 6 | static_cast<std::uint32_t>(value);
      ++characters;
    }
    for (int b = 0; b < 3 - padding; ++b) decoded_.push_back(static_cast<char>(bits >> (16 - 8 * b) & 0xff));
    return padding < 3;
  }

  std::string_view text_;
  bool base64_;
  std::string decoded_;
};

class VtkXml : public ForeignReader {
 public:
  explicit VtkXml(const std::filesystem::path& file) : file_(file) {}

  bool next(ForeignFrame& frame) override {
    if (read_) return false;
    read_ = true;
    frame = {};
    frame.file = file_;
    load();
    const pugi::xml_node root = document_.child("VTKFile");
    const std::string type = root.attribute("type").value();
    if (type != "PolyData" && type != "UnstructuredGrid")
      throw refusal(
          fmt::format("type {} is not read; give PolyData (.vtp) or an UnstructuredGrid (.vtu)", in_quotes(type)));
    const std::string order = root.attribute("byte_order").as_string("LittleEndian");
    if (order != "LittleEndian") throw refusal("byte_order " + in_quotes(order) + " is not read; write LittleEndian");
    compressor_ = root.attribute("compressor").value();
    if (!compressor_.empty() && compressor_ != "vtkZLibDataCompressor")
      throw refusal(fmt::format("compressor {} is not read; write with zlib or none", in_quotes(compressor_)));
    wide_ = std::string(root.attribute("header_type").as_string("UInt32")) == "UInt64";
    const pugi::xml_node data = root.child(type.c_str());
    if (data.select_nodes("Piece").size() != 1) throw refusal("must have one Piece; merge them");
    take_field_data(data.child("FieldData"), frame);
    take_points(data.child("Piece"), frame.table);
    return true;
  }

 private:
  InvalidInput refusal(const std::string& why) const {
    return InvalidInput(fmt::format("{}: {}", file_.string(), why));
  }

  /// The XML, and apart from it what is appended, which may be no text.
  void load() {
    TextFile(file_, "give a VTK file in XML (.vtp, .vtu)");  // there, and no folder
    content_ = read_bytes(file_);
    std::string_view xml = content_;
    std::string closed;
    if (const std::size_t at = content_.find("<AppendedData"); at != std::string::npos) {
      const std::size_t begin = content_.find('>', at), mark = content_.find('_', begin);
      if (begin == std::string::npos || mark == std::string::npos) throw refusal("is cut within its appended data");
      appended_base64_ = content_.substr(at, begin - at).find("raw") == std::string::npos;
      appended_ = std::string_view(content_).substr(mark + 1);
      if (const std::size_t end = appended_.rfind("</AppendedData"); end != std::string_view::npos)
        appended_ = appended_.substr(0, end);
      xml = closed = content_.substr(0, at) + "</VTKFile>";
    }
    const pugi::xml_parse_result result = document_.load_buffer(xml.data(), xml.size());
    if (!result)
      throw refusal(
          fmt::format("byte {}: {}; is it a VTK file in XML, and whole?", result.offset, result.description()));
  }

  void take_field_data(const pugi::xml_node& fields, ForeignFrame& frame) const {
    for (const pugi::xml_node& array : fields.children("DataArray")) {
      const std::string name = array.attribute("Name").value();
      if (name == "TimeValue") frame.time = values_of(array, 1)[0];
      if (name == "cell") {
        const std::vector<double> H = values_of(array, 9);
        frame.H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(H.data());
      }
    }
  }

  void take_points(const pugi::xml_node& piece, NumberTable& table) const {
    const std::size_t points = whole(piece.attribute("NumberOfPoints").value(), "NumberOfPoints");
    std::vector<std::pair<std::size_t, std::vector<double>>> arrays;
    for (const pugi::xml_node& array : piece.child("Points").children("DataArray"))
      add(array, "Points", points, table, arrays);
    if (arrays.size() != 1) throw refusal("must have one array of Points");
    for (const pugi::xml_node& array : piece.child("PointData").children("DataArray"))
      add(array, array.attribute("Name").value(), points, table, arrays);
    table.values.reserve(points * table.columns.size());
    for (std::size_t i = 0; i < points; ++i) {
      for (const auto& [components, values] : arrays) {
        for (std::size_t c = 0; c < components; ++c) table.values.push_back(values[i * components + c]);
      }
    }
  }

  void add(const pugi::xml_node& array, const std::string& name, std::size_t points, NumberTable& table,
           std::vector<std::pair<std::size_t, std::vector<double>>>& arrays) const {
    const char* text = array.attribute("NumberOfComponents").value();
    const std::size_t components = *text == '\0' ? 1 : whole(text, "NumberOfComponents");
    if (components < 1 || components > 100) throw refusal("NumberOfComponents: must be 1 to 100");
    for (std::string& title : component_titles(name, components)) table.columns.push_back(std::move(title));
    arrays.emplace_back(components, values_of(array, points * components));
  }

  std::size_t whole(const char* text, const char* what) const {
    const auto count = number_of<std::int64_t>(text);
    if (!count || *count < 0 || *count > static_cast<std::int64_t>(kMaxForeignRows))
      throw refusal(fmt::format("{}: {} is no whole number, 0 to 1e8", what, in_quotes(text)));
    return static_cast<std::size_t>(*count);
  }

  std::vector<double> values_of(const pugi::xml_node& array, std::size_t count) const {
    const std::string name = in_quotes(array.attribute("Name").value()), format = array.attribute("format").value();
    if (format == "ascii") {
      std::string text = array.child_value();
      for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
      std::vector<std::string_view> words;
      split_words(text, words);
      if (words.size() != count)
        throw refusal(fmt::format("array {}: {} numbers where {} must be", name, words.size(), count));
      std::vector<double> values;
      for (const std::string_view word : words) values.push_back(decimal(word).value_or(NAN));
      return values;
    }
    if (format == "binary") {
      return numbers(array.attribute("type").value(), count, name, Bytes(trimmed_lines(array.child_value()), true));
    }
    if (format != "appended") throw refusal(fmt::format("array {}: format {} is not known", name, in_quotes(format)));
    const auto offset = number_of<std::int64_t>(array.attribute("offset").value());
    if (!offset || *offset < 0 || static_cast<std::size_t>(*offset) > appended_.size())
      throw refusal(fmt::format("array {}: its offset lies outside the appended data; is the file cut?", name));
    return numbers(array.attribute("type").value(), count, name,
                   Bytes(appended_.substr(static_cast<std::size_t>(*offset)), appended_base64_));
  }

  static std::string_view trimmed_lines(std::string_view text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    return text.substr(begin);
  }

  std::vector<double> numbers(const std::string& type, std::size_t count, const std::string& name, Bytes bytes) const {
    if (type == "Float64") return converted<double>(count, name, bytes);
    if (type == "Float32") return converted<float>(count, name, bytes);
    if (type == "Int64") return converted<std::int64_t>(count, name, bytes);
    if (type == "Int32") return converted<std::int32_t>(count, name, bytes);
    if (type == "UInt64") return converted<std::uint64_t>(count, name, bytes);
    if (type == "UInt32") return converted<std::uint32_t>(count, name, bytes);
    if (type == "Int16") return converted<std::int16_t>(count, name, bytes);
    if (type == "UInt16") return converted<std::uint16_t>(count, name, bytes);
    if (type == "Int8") return converted<std::int8_t>(count, name, bytes);
    if (type == "UInt8") return converted<std::uint8_t>(count, name, bytes);
    throw refusal(fmt::format("array {}: type {} is not read", name, in_quotes(type)));
  }

  template <class Number>
  std::vector<double> converted(std::size_t count, const std::string& name, Bytes& bytes) const {
    const std::string data = data_of(count * sizeof(Number), name, bytes);
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      Number number;
      std::memcpy(&number, data.data() + i * sizeof(Number), sizeof(Number));
      values[i] = static_cast<double>(number);
    }
    return values;
  }

  std::string data_of(std::size_t size, const std::string& name, Bytes& bytes) const {
    const auto cut = [&] {
      return refusal(
          fmt::format("array {}: does not hold the {} bytes that it must; is the file cut, or its number of "
                      "points wrong?",
                      name, size));
    };
    const auto header = [&] {
      std::string word;
      if (!bytes.take(wide_ ? 8 : 4, word)) throw cut();
      std::uint64_t value = 0;
      std::memcpy(&value, word.data(), word.size());
      return value;
    };
    std::string data;
    if (compressor_.empty()) {
      if (header() != size || !bytes.take(size, data)) throw cut();
      return data;
    }
    const std::uint64_t blocks = header(), block = header(), last = header();
    if (size == 0 && blocks == 0) return data;
    if (size > kMostInflated * bytes.most_left() || blocks == 0 || blocks > size || (blocks > 1 && block > size) ||
        (last > 0 ? (blocks - 1) * block + last : blocks * block) != size)
      throw cut();
    std::vector<std::uint64_t> packed(blocks);
    for (std::uint64_t& each : packed) each = header();
    for (std::uint64_t b = 0; b < blocks; ++b) {
      std::string from, to(b + 1 == blocks && last > 0 ? last : block, '\0');
      uLongf length = to.size();
      if (!bytes.take(packed[b], from) ||
          uncompress(reinterpret_cast<Bytef*>(to.data()), &length, reinterpret_cast<const Bytef*>(from.data()),
                     from.size()) != Z_OK ||
          length != to.size())
        throw cut();
      data += to;
    }
    return data;
  }

  std::filesystem::path file_;
  bool read_ = false, wide_ = false, appended_base64_ = true;
  std::string content_, compressor_;
  std::string_view appended_;
  pugi::xml_document document_;
};

}  // namespace

std::unique_ptr<ForeignReader> read_vtk_xml(const std::filesystem::path& file) {
  return std::make_unique<VtkXml>(file);
}

}  // namespace grainlaw::dem
