#pragma once
// Comma separated tables of numbers: one header line `name` or `name[unit]`, decimal points, an empty field where a
// quantity is undefined. Reading is bounded in memory and refuses anything else, naming row and column.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw {

inline constexpr std::size_t kMaxCsvLine = 1u << 20;  ///< longer lines are refused [byte]
inline constexpr std::size_t kMaxCsvColumns = 1000;   ///< more are refused
inline constexpr std::size_t kMaxCsvRows = 1000000;   ///< more are refused

/// Reads a table row by row. Throws InvalidInput naming file, row (1 is the first below the header) and column.
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& file);

  const std::vector<std::string>& header() const { return header_; }  ///< column titles in the order of the file
  const std::string& name() const { return name_; }                   ///< of the file, for messages
  std::size_t row() const { return row_; }                            ///< number of the row read last

  /// The next row, NaN for empty fields, as many values as the header; false at the end.
  bool next(std::vector<double>& values);

  /// Throws InvalidInput for the row read last; `column` may be empty.
  [[noreturn]] void refuse(const std::string& column, const std::string& reason) const;

 private:
  bool next_line();

  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::string line_;
  std::vector<std::string> header_;
  std::size_t row_ = 0;
};

/// Shortest decimal text that reads back as the same double; empty for NaN. Throws Error for infinities.
std::string csv_number(double value);

/// Splits at commas; views into `line`.
std::vector<std::string_view> split_fields(std::string_view line);

}  // namespace grainlaw
