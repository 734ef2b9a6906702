// Rows of numbers between blanks or commas, with their titles in the first line, which may begin with '#'. YADE's
// export.text and textExt write "#format x_y_z_r..." there. Other lines that begin with '#' and empty ones are skipped.

#include <fmt/format.h>

#include "dem/foreign/foreign_frame.hpp"

namespace grainlaw::dem {
namespace {

class TextTable : public ForeignReader {
 public:
  explicit TextTable(const std::filesystem::path& file) : lines_(file, "give a table of text") {}

  bool next(ForeignFrame& frame) override {
    if (read_) return false;
    read_ = true;
    frame = {};
    frame.file = lines_.file();
    NumberTable& table = frame.table;
    std::vector<std::string_view> words;
    while (lines_.next()) {
      const std::string_view line = trimmed(lines_.line());
      if (line.empty() || (line.starts_with('#') && !table.columns.empty())) continue;
      split_words(line, words, true);
      if (table.columns.empty()) {
        take_titles(words, table.columns);
        continue;
      }
      if (table.first_line == 0) table.first_line = lines_.number();
      if (table.first_line + table.rows() != lines_.number())
        throw lines_.refusal("", "follows an empty line or a comment; remove that");
      if (words.size() != table.columns.size()) {
        throw lines_.refusal("", fmt::format("has {} words where there are {} titles; is the file cut?", words.size(),
                                             table.columns.size()));
      }
      if (table.rows() == kMaxForeignRows) throw lines_.refusal("", "more than 1e8 rows are not supported");
      for (const std::string_view word : words)
        table.values.push_back(decimal(word).value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (table.columns.empty()) throw lines_.refusal(1, "", "the file is empty; give titles and rows of numbers");
    return true;
  }

 private:
  void take_titles(std::vector<std::string_view> words, std::vector<std::string>& titles) const {
    if (!words.empty() && words[0] == "#format" && words.size() == 2) {
      for (std::string_view rest = words[1]; !rest.empty();) {
        const std::size_t end = std::min(rest.find('_'), rest.size());
        titles.emplace_back(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
      return;
    }
    if (!words.empty() && words[0] == "#") words.erase(words.begin());
    if (!words.empty() && words[0].starts_with('#')) words[0].remove_prefix(1);
    bool numbers = words.empty();
    for (const std::string_view word : words) numbers = numbers || decimal(word);
    if (numbers) throw lines_.refusal("", "names no columns; write their titles into the first line, e.g. '# x y z r'");
    titles.assign(words.begin(), words.end());
  }

  TextFile lines_;
  bool read_ = false;
};

}  // namespace

std::unique_ptr<ForeignReader> read_text_table(const std::filesystem::path& file) {
  return std::make_unique<TextTable>(file);
}

}  // namespace grainlaw::dem
