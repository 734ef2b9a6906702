#include "dem/foreign/foreign_frame.hpp"

#include <fmt/format.h>

#include "model/files/one_line.hpp"

namespace grainlaw::dem {

std::string ForeignFrame::where(std::size_t row) const {
  std::string text = file.string();
  if (!place.empty()) text += ": " + place;
  if (row > 0) {
    text += table.first_line > 0 ? fmt::format(": line {}", table.first_line + row - 1) : fmt::format(": row {}", row);
  }
  return text;
}

InvalidInput ForeignFrame::refusal(const std::string& why, std::size_t row, const std::string& column) const {
  return InvalidInput(one_line(where(row) + (column.empty() ? "" : ", column " + in_quotes(column)) + ": " + why));
}

std::vector<std::string> component_titles(const std::string& name, std::size_t components) {
  if (components == 1) return {name};
  std::vector<std::string> titles;
  for (std::size_t c = 0; c < components; ++c)
    titles.push_back(name + "_" + (components == 3 ? std::string(1, "xyz"[c]) : std::to_string(c)));
  return titles;
}

void read_rows(TextFile& lines, std::size_t rows, NumberTable& table) {
  const std::size_t columns = table.columns.size();
  std::vector<std::string_view> words;
  table.first_line = lines.number() + 1;
  for (std::size_t row = 0; row < rows; ++row) {
    if (!lines.next()) {
      throw lines.refusal("", fmt::format("the file ends after {} of {} rows of a frame; write it whole, or cut the "
                                          "frame off",
                                          row, rows));
    }
    split_words(lines.line(), words);
    if (words.size() != columns) {
      throw lines.refusal("",
                          fmt::format("has {} words where the frame has {} columns; is the frame cut, or their number "
                                      "({} rows) wrong?",
                                      words.size(), columns, rows));
    }
    for (const std::string_view word : words)
      table.values.push_back(decimal(word).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
}

std::size_t row_count(const TextFile& lines, std::string_view text) {
  const auto count = number_of<std::int64_t>(trimmed(text));
  if (!count || *count < 0 || *count > static_cast<std::int64_t>(kMaxForeignRows)) {
    throw lines.refusal("", fmt::format("{} is no number of rows, 0 to 1e8", in_quotes(text)));
  }
  return static_cast<std::size_t>(*count);
}

}  // namespace grainlaw::dem
