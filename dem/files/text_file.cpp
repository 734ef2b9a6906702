#include "dem/files/text_file.hpp"

#include <fmt/format.h>

#include "model/files/one_line.hpp"
#include "model/files/reading.hpp"

namespace grainlaw::dem {
namespace {

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
  return InvalidInput(one_line(fmt::format("{}: {}: {}", file_.string(), where, why)));
}

std::string in_quotes(std::string_view text) { return fmt::format("'{}'", one_line(text, 40)); }

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

}  // namespace grainlaw::dem
