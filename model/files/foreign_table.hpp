#pragma once
// Tables of numbers as others write them: text with delimiters or blanks, numpy's .npy and .npz. Reading is bounded in memory
// and guesses nothing about a number: what is none stays named, and is refused by whoever needs it.

#include <filesystem>
#include <string>
#include <vector>

namespace grainlaw {

struct ForeignColumn {
  std::string title;           ///< as it stands there; its number from 1 where there is no header
  std::vector<double> values;  ///< NaN where empty or no number
  std::size_t bad_row = 0;     ///< first row, from 0, that holds something else than a number, where `bad` is not empty
  std::string bad;             ///< what stands there
  std::string unit = {};       ///< in a text's line of units; then part of the title
};

struct ForeignTable {
  std::string name;  ///< of the file, for messages
  std::vector<ForeignColumn> columns;
  std::vector<std::size_t> lines;     ///< of each row in a text, from 1; empty: not a text
  std::vector<std::string> left_out;  ///< what else the file holds, in words

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
  /// "FILE: line 17", or "FILE: row 3" (counted from 1).
  std::string place(std::size_t row) const;
};

inline constexpr std::size_t kMaxForeignBytes = std::size_t{512} << 20;  ///< larger files or arrays are refused [byte]

/// How a table is laid out, as far as its file does not say it.
struct TableLayout {
  char delimiter = 0;                   ///< of a text; ' ' any blanks; 0: seen from the first line
  std::string array = {};               ///< of an .npz
  std::vector<std::string> names = {};  ///< of the columns; empty: a header, or numbers
  char decimal = '.';                   ///< in a text's numbers; ',' where they are written so, and never both
  std::size_t skip = 0;                 ///< lines of a text that are not read, above its header
};

/// By the file's first bytes. Throws InvalidInput naming file and line, or what of the format is not as it must be.
ForeignTable read_foreign_table(const std::filesystem::path& file, const TableLayout& layout);

/// A text: '#' begins a comment, blank lines are skipped. The header is the first line if it has a word that is no number, or
/// a comment just before the first row with as many words as there are columns. Of a line below the first kind that has words
/// and no number each word is a unit: columns "p" over "kPa" or "[kPa]" are called "p[kPa]".
ForeignTable table_of_text(std::string_view text, const std::string& name, const TableLayout& layout);

}  // namespace grainlaw
