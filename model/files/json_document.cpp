#include "model/files/json_document.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

/// Builds the document and refuses what JSON allows but no input of ours needs.
class StrictBuilder final : public nlohmann::json_sax<Json> {
 public:
  StrictBuilder(const std::string& name, JsonSource source) : name_(name), source_(source) {}

  Json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(std::int64_t value) override {
    if (value == 0 && source_ == JsonSource::user) refuse_negative_zero();
    return put(value);
  }
  bool number_unsigned(std::uint64_t value) override {
    // as integers beyond 2^63 the checker of schemas would take them for negative ones, which a bound may allow
    return std::in_range<std::int64_t>(value) ? put(value) : put(static_cast<double>(value));
  }
  bool number_float(double value, const std::string&) override {
    if (source_ != JsonSource::own) {
      if (value == 0 && std::signbit(value) && source_ == JsonSource::user) refuse_negative_zero();
      if (value == std::trunc(value) && std::abs(value) < 9.0e18) return put(static_cast<std::int64_t>(value));
    }
    return put(value);
  }
  bool string(std::string& value) override { return put(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return shut(); }
  bool end_array() override { return shut(); }

  bool key(std::string& name) override {
    key_ = name;
    if (open_.back().value->contains(name)) refuse("is given twice; keep one");
    return true;
  }

  bool parse_error(std::size_t, const std::string& last_token, const nlohmann::detail::exception& error) override {
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow)
      refuse(fmt::format("{} is beyond the range of numbers; give a finite number", one_line(last_token, 40)));
    std::string reason = error.what();
    if (const auto end_of_tag = reason.find("] "); end_of_tag != std::string::npos) reason.erase(0, end_of_tag + 2);
    refuse(one_line(reason, 200) + "; the file must be one JSON document in UTF-8");
  }

 private:
  struct Level {
    Json* value;
    std::string key;  // under which the value hangs in its parent object; empty in arrays
  };

  template <class Value>
  bool put(Value&& value) {
    if (open_.empty()) {
      root_ = std::forward<Value>(value);
    } else {
      insert(Json(std::forward<Value>(value)));
    }
    return true;
  }

  Json* insert(Json value) {
    Json& parent = *open_.back().value;
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    return &(parent[key_] = std::move(value));
  }

  bool open(Json container) {
    if (open_.size() >= static_cast<std::size_t>(kMaxJsonDepth)) {
      refuse(fmt::format("is nested deeper than {} levels; flatten it", kMaxJsonDepth));
    }
    if (open_.empty()) {
      root_ = std::move(container);
      open_.push_back({&root_, ""});
    } else {
      const std::string key = open_.back().value->is_object() ? key_ : "";
      Json* inserted = insert(std::move(container));
      open_.push_back({inserted, key});
    }
    return true;
  }

  bool shut() {
    open_.pop_back();
    return true;
  }

  /// A setting of -0 is a slip. In a matrix it is what programs write for a component that vanishes, and read as 0.
  void refuse_negative_zero() const {
    const std::size_t n = open_.size();
    const bool in_matrix = n >= 2 && open_[n - 1].value->is_array() && open_[n - 2].value->is_array();
    if (!in_matrix) refuse("negative zero is refused; write 0");
  }

  std::string place() const {
    std::string path;
    for (std::size_t i = 0; i < open_.size() && path.size() < 200; ++i) {
      const bool last = i + 1 == open_.size();
      if (open_[i].value->is_array()) {
        path += fmt::format("[{}]", open_[i].value->size() - (last ? 0 : 1));
      } else {
        const std::string& key = last ? key_ : open_[i + 1].key;
        if (!key.empty()) path += fmt::format("{}{}", path.empty() ? "" : ".", one_line(key, 40));
      }
    }
    return path;
  }

  [[noreturn]] void refuse(const std::string& reason) const {
    const std::string where = place();
    throw InvalidInput(where.empty() ? fmt::format("{}: {}", name_, reason)
                                     : fmt::format("{}: {}: {}", name_, where, reason));
  }

  const std::string& name_;
  JsonSource source_;
  Json root_;
  std::string key_;
  std::vector<Level> open_;
};

std::string scalar_text(const OrderedJson& value, const std::string& key) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    throw Error(fmt::format("{}: is not a finite number and was not written", key));
  }
  return value.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

/// True when the array fits on one line: plain values only, or short rows of them.
bool is_flat(const OrderedJson& array) {
  for (const auto& element : array) {
    if (element.is_structured()) return false;
  }
  return true;
}

void write_value(const OrderedJson& value, const std::string& key, std::string indent, std::string& out) {
  if (!value.is_structured()) {
    out += scalar_text(value, key);
    return;
  }
  if (value.empty()) {
    out += value.is_array() ? "[]" : "{}";
    return;
  }
  const bool flat = value.is_array() && is_flat(value);
  out += value.is_array() ? "[" : "{";
  if (!flat) indent += "  ";
  bool first = true;
  for (const auto& item : value.items()) {
    out += first ? "" : flat ? ", " : ",";
    if (!flat) out.append("\n").append(indent);
    first = false;
    const std::string name = key.empty() ? item.key() : fmt::format("{}.{}", key, item.key());
    if (value.is_object()) out += OrderedJson(item.key()).dump() + ": ";
    write_value(item.value(), name, indent, out);
  }
  if (!flat) out.append("\n").append(indent, 2);
  out += value.is_array() ? "]" : "}";
}

}  // namespace

Json parse_json(std::string_view text, const std::string& name, JsonSource source) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") {
    throw InvalidInput(fmt::format("{}: begins with a byte order mark; save it as UTF-8 without one", name));
  }
  // the parser takes a NUL byte for the end of the document
  if (text.find('\0') != std::string_view::npos) {
    throw InvalidInput(fmt::format("{}: holds a NUL byte; the file must be one JSON document in UTF-8", name));
  }
  const bool comments = source != JsonSource::own;  // are skipped
  StrictBuilder builder(name, source);
  if (!Json::sax_parse(text.begin(), text.end(), &builder, Json::input_format_t::json, true, comments)) {
    throw InvalidInput(fmt::format("{}: is not a JSON document", name));
  }
  return builder.take();
}

Json read_json(const std::filesystem::path& file, JsonSource source) {
  const std::string name = one_line(file.string(), 200);
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw InvalidInput(fmt::format("{}: is a folder; give a JSON file", name));
  }
  const std::string text =
      read_bytes(file, "give the path of a JSON file", kMaxJsonBytes, "no document of this kind is");
  return parse_json(text, name, source);
}

std::string json_text(const OrderedJson& document) {
  std::string text;
  write_value(document, "", "", text);
  return text + "\n";
}

void write_json(const std::filesystem::path& file, const OrderedJson& document) {
  std::string text;
  try {
    text = json_text(document);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.what()));
  }
  write_durably(file, text);
}

OrderedJson number_or_null(double value) { return std::isnan(value) ? OrderedJson(nullptr) : OrderedJson(value); }

double number_or_nan(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

}  // namespace grainlaw
