#include "dem/files/text_file.hpp"

#include <fmt/format.h>

#include <charconv>

#include "model/files/reading.hpp"

namespace grainlaw::dem {
namespace {

template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number value{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool blank(char c) { return c == ' ' || c == '\t'; }

}  // namespace

TextFile::TextFile(std::filesystem::path file, std::string_view remedy)
    : file_(std::move(file)), in_(std::fopen(file_.c_str(), "rb"), std::fclose) {
  if (!in_) fail_to_read(file_.string(), "read", remedy);
  std::error_code failure;
  if (std::filesystem::is_directory(file_, failure))
    throw InvalidInput(fmt::format("{}: cannot be read: is a folder; {}", file_.string(), remedy));
}

bool TextFile::next() {
  line_.clear();
  int c = getc_unlocked(in_.get());
  if (std::ferror(in_.get())) fail_to_read(file_.string(), "read");
  if (c == EOF) return false;
  ++number_;
  for (; c != EOF && c != '\n'; c = getc_unlocked(in_.get())) {
    if (c == 0) throw refusal("", "holds a NUL byte; give plain text");
    if (line_.size() == kMaxTextLine) throw refusal("", "is longer than 1 MB; give one sphere per line");
    line_.push_back(static_cast<char>(c));
  }
  if (std::ferror(in_.get())) fail_to_read(file_.string(), "read");
  if (!line_.empty() && line_.back() == '\r') line_.pop_back();
  return true;
}

InvalidInput TextFile::refusal(std::size_t line, std::string_view column, const std::string& why) const {
  const std::string where =
      column.empty() ? fmt::format("line {}", line) : fmt::format("line {}, column {}", line, column);
  return InvalidInput(fmt::format("{}: {}: {}", file_.string(), where, why));
}

std::string in_quotes(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += (c >= ' ' && c <= '~') ? c : '?';
  return "'" + shown + (text.size() > 40 ? "...'" : "'");
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

void split_words(std::string_view line, std::vector<std::string_view>& words, bool commas) {
  words.clear();
  const auto between = [commas](char c) { return blank(c) || (commas && c == ','); };
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && between(line[i])) ++i;
    const std::size_t begin = i;
    while (i < line.size() && !between(line[i])) ++i;
    if (i > begin) words.push_back(line.substr(begin, i - begin));
  }
}

std::optional<double> decimal(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return parse<double>(text);
}

std::optional<std::int64_t> integer(std::string_view text) { return parse<std::int64_t>(text); }

}  // namespace grainlaw::dem
