#include "model/files/foreign_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "model/files/csv_table.hpp"
#include "model/files/npy.hpp"
#include "model/files/npz.hpp"
#include "model/files/number_text.hpp"
#include "model/files/one_line.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

std::string_view without_quotes(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'');
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// Words between delimiters; ' ' stands for any number of blanks.
std::vector<std::string_view> words_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> words;
  line = trimmed(line);
  while (words.size() <= kMaxCsvColumns) {
    const auto end = delimiter == ' ' ? line.find_first_of(" \t") : line.find(delimiter);
    words.push_back(without_quotes(trimmed(line.substr(0, end))));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end + 1);
    if (delimiter == ' ') line = trimmed(line);
  }
  return words;
}

/// Semicolons and tabs come before commas: who uses them writes no commas but in numbers.
char delimiter_of(std::string_view line, char decimal) {
  for (const char delimiter : {';', '\t', ','}) {
    if (delimiter != decimal && trimmed(line).find(delimiter) != std::string_view::npos) return delimiter;
  }
  return ' ';
}

/// A number, NaN for an empty word (a gap); nothing for what is neither.
std::optional<double> number_or_gap(std::string_view word, char decimal_sign) {
  if (word.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (decimal_sign == '.') return decimal(word);
  if (word.find('.') != std::string_view::npos) return std::nullopt;  // of thousands, or this table has decimal points
  std::string pointed(word);
  std::ranges::replace(pointed, decimal_sign, '.');
  return decimal(pointed);
}

class TextTable {
 public:
  TextTable(const std::string& name, const TableLayout& layout)
      : delimiter_(layout.delimiter), decimal_(layout.decimal), skip_(layout.skip) {
    table_.name = name;
  }

  ForeignTable read(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    if (text.find('\0') != std::string_view::npos)
      throw InvalidInput(fmt::format("{}: holds a NUL byte; give a text, .npy or .npz", table_.name));
    while (!text.empty()) {
      const auto end = text.find('\n');
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      ++line_;
      if (line.size() > kMaxCsvLine) refuse(fmt::format("is longer than {} bytes", kMaxCsvLine));
      if (line_ > skip_) take(trimmed(line));
    }
    if (table_.rows() == 0)
      throw InvalidInput(
          fmt::format("{}: has no rows of numbers; give a table with one row for each instant", table_.name));
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput(fmt::format("{}: line {}: {}", table_.name, line_, why));
  }

  void take(std::string_view line) {
    if (line.empty()) return;
    if (line.front() == '#') {
      if (table_.columns.empty()) comment_ = trimmed(line.substr(1));
      return;
    }
    line = trimmed(line.substr(0, line.find('#')));
    if (delimiter_ == 0) delimiter_ = delimiter_of(line, decimal_);
    const std::vector<std::string_view> words = words_of(line, delimiter_);
    if (words.size() > kMaxCsvColumns) refuse(fmt::format("more than {} columns", kMaxCsvColumns));
    if (table_.columns.empty()) {
      below_header_ = begin(words);
      if (below_header_) return;
    }
    if (!below_header_ || !are_units(words)) add_row(words);
    below_header_ = false;
  }

  /// The columns by the first line; true when it is their header.
  bool begin(const std::vector<std::string_view>& words) {
    bool header = false;
    for (const std::string_view word : words) header = header || !number_or_gap(word, decimal_);
    std::vector<std::string_view> titles;
    if (header)
      titles = words;
    else if (words_of(comment_, delimiter_).size() == words.size() && !comment_.empty())
      titles = words_of(comment_, delimiter_);
    else if (words_of(comment_, ' ').size() == words.size() && !comment_.empty())
      titles = words_of(comment_, ' ');
    for (std::size_t i = 0; i < words.size(); ++i)
      table_.columns.push_back({titles.empty() ? std::to_string(i + 1) : std::string(titles[i]), {}, 0, ""});
    return header;
  }

  /// True when the line just below the header is one of units, which the columns then have.
  bool are_units(const std::vector<std::string_view>& words) {
    bool any = false;
    for (const std::string_view word : words) {
      if (word.empty()) continue;
      const auto digit = word.find_first_of("0123456789");
      const bool begins_as_number = digit != std::string_view::npos && word.find_first_not_of("+-.,") == digit;
      if (begins_as_number || number_or_gap(word, decimal_)) return false;  // 1,5 is a number of others
      any = true;
    }
    if (!any || words.size() != table_.columns.size()) return false;
    for (std::size_t i = 0; i < words.size(); ++i) {
      const bool bracketed = words[i].size() > 2 && (words[i].front() == '[' || words[i].front() == '(');
      table_.columns[i].unit = trimmed(bracketed ? words[i].substr(1, words[i].size() - 2) : words[i]);
    }
    return true;
  }

  void add_row(const std::vector<std::string_view>& words) {
    if (words.size() != table_.columns.size())
      refuse(
          fmt::format("{} words where there are {} columns; numbers have decimal {}s, and what is undefined is "
                      "nan or empty between delimiters; lines above the header are left out by skip",
                      words.size(), table_.columns.size(), decimal_ == '.' ? "point" : "comma"));
    if (table_.rows() == kMaxCsvRows) refuse(fmt::format("more than {} rows; thin the series", kMaxCsvRows));
    for (std::size_t i = 0; i < words.size(); ++i) {
      ForeignColumn& column = table_.columns[i];
      const std::optional<double> value = number_or_gap(words[i], decimal_);
      if (!value && column.bad.empty()) {
        column.bad_row = column.values.size();
        column.bad = one_line(words[i], 40);
      }
      column.values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    table_.lines.push_back(line_);
  }

  char delimiter_, decimal_;
  ForeignTable table_;
  std::string_view comment_;
  std::size_t line_ = 0, skip_;
  bool below_header_ = false;
};

/// Titles by what the layout says, all different.
void set_titles(const TableLayout& layout, ForeignTable& table) {
  if (!layout.names.empty() && layout.names.size() != table.columns.size())
    throw InvalidInput(fmt::format("{}: has {} columns where names has {}; name each", table.name, table.columns.size(),
                                   layout.names.size()));
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::string& title = table.columns[i].title;
    if (!layout.names.empty()) title = layout.names[i];
    if (!table.columns[i].unit.empty()) title += fmt::format("[{}]", table.columns[i].unit);
    for (std::size_t k = 0; k < i; ++k) {
      if (table.columns[k].title == title)
        throw InvalidInput(fmt::format("{}: columns {} and {} are both called '{}'; rename one, or give names",
                                       table.name, k + 1, i + 1, one_line(title, 60)));
    }
  }
}

std::string bytes_of(const std::filesystem::path& file, const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    throw InvalidInput(fmt::format("{}: is no regular file; give a table", name));
  return read_bytes(file, "give a table", kMaxForeignBytes, "thin the series");
}

}  // namespace

std::string ForeignTable::place(std::size_t row) const {
  return lines.empty() ? fmt::format("{}: row {}", name, row + 1) : fmt::format("{}: line {}", name, lines.at(row));
}

ForeignTable table_of_text(std::string_view text, const std::string& name, const TableLayout& layout) {
  ForeignTable table = TextTable(name, layout).read(text);
  set_titles(layout, table);
  return table;
}

ForeignTable read_foreign_table(const std::filesystem::path& file, const TableLayout& layout) {
  const std::string name = one_line(file.string(), 200), bytes = bytes_of(file, name);
  ForeignTable table;
  if (bytes.starts_with(kNpyMagic))
    table = table_of_npy(parse_npy(bytes, name), name);
  else if (bytes.starts_with("PK"))
    table = table_of_npz(bytes, name, layout.array);
  else
    return table_of_text(bytes, name, layout);
  if (table.rows() == 0) throw InvalidInput(fmt::format("{}: has no rows; give one for each instant", name));
  if (table.rows() > kMaxCsvRows)
    throw InvalidInput(fmt::format("{}: more than {} rows; thin the series", name, kMaxCsvRows));
  set_titles(layout, table);
  return table;
}

}  // namespace grainlaw
