#include "model/files/csv_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "model/files/number_text.hpp"
#include "model/files/one_line.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {

std::vector<std::string_view> split_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(line.substr(begin, comma == std::string_view::npos ? comma : comma - begin));
    if (comma == std::string_view::npos || fields.size() > kMaxCsvColumns) return fields;
    begin = comma + 1;
  }
}

std::string csv_number(double value) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) throw Error("an infinite number was not written to a table");
  return fmt::format("{}", value);
}

CsvReader::CsvReader(const std::filesystem::path& file)
    : name_(one_line(file.string(), 200)), in_(std::fopen(file.c_str(), "rb"), std::fclose), buffer_(1 << 16) {
  std::error_code error;
  if (!in_) fail_to_read(name_, "opened", "give a CSV file");
  if (std::filesystem::is_directory(file, error))
    throw InvalidInput(fmt::format("{}: cannot be opened: is a folder; give a CSV file", name_));
  if (!next_line()) throw InvalidInput(fmt::format("{}: is empty; the first line must name the columns", name_));
  if (std::string_view(line_).substr(0, 3) == "\xEF\xBB\xBF") {
    throw InvalidInput(fmt::format("{}: begins with a byte order mark; save it as UTF-8 without one", name_));
  }
  const auto fields = split_fields(line_);
  if (fields.size() > kMaxCsvColumns) {
    throw InvalidInput(fmt::format("{}: header: more than {} columns", name_, kMaxCsvColumns));
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (const std::string& earlier : header_) {
      if (earlier == fields[i]) {
        throw InvalidInput(
            fmt::format("{}: header: column '{}' is given twice; keep one", name_, one_line(fields[i], 60)));
      }
    }
    header_.emplace_back(fields[i]);
  }
}

bool CsvReader::next_line() {
  line_.clear();
  for (;;) {
    if (begin_ == end_) {
      begin_ = 0;
      end_ = std::fread(buffer_.data(), 1, buffer_.size(), in_.get());
      if (std::ferror(in_.get())) fail_to_read(name_, "read");
      if (end_ == 0) break;
    }
    const char* const from = buffer_.data() + begin_;
    const auto* const newline = static_cast<const char*>(std::memchr(from, '\n', end_ - begin_));
    const std::size_t length = newline ? static_cast<std::size_t>(newline - from) : end_ - begin_;
    if (line_.size() + length > kMaxCsvLine) refuse("", fmt::format("the line is longer than {} bytes", kMaxCsvLine));
    line_.append(from, length);
    begin_ += length + (newline ? 1 : 0);
    if (newline) {
      if (!line_.empty() && line_.back() == '\r') line_.pop_back();
      if (line_.find('\0') != std::string::npos) refuse("", "holds a NUL byte; the file must be text");
      return true;
    }
  }
  if (line_.find('\0') != std::string::npos) refuse("", "holds a NUL byte; the file must be text");
  if (!line_.empty() && line_.back() == '\r') line_.pop_back();
  return !line_.empty();
}

bool CsvReader::next(std::vector<double>& values) {
  ++row_;  // before reading, so that messages name the row that is being read
  if (!next_line()) return false;
  if (row_ > kMaxCsvRows) refuse("", fmt::format("more than {} rows; thin the series", kMaxCsvRows));
  const auto fields = split_fields(line_);
  if (fields.size() != header_.size()) {
    refuse("", fmt::format("{} fields where the header has {} (numbers are written with a decimal point)",
                           fields.size() > kMaxCsvColumns ? fmt::format("more than {}", kMaxCsvColumns)
                                                          : fmt::format("{}", fields.size()),
                           header_.size()));
  }
  values.resize(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string_view field = fields[i];
    if (field.empty()) {
      values[i] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    values[i] = number_of<double>(field).value_or(std::numeric_limits<double>::infinity());
    if (!std::isfinite(values[i])) {
      refuse(header_[i],
             fmt::format("'{}' is not a finite number; write it like 1.5e-3, or leave the field empty where undefined",
                         one_line(field, 40)));
    }
  }
  return true;
}

void CsvReader::refuse(const std::string& column, const std::string& reason) const {
  const std::string where = row_ == 0 ? "header" : fmt::format("row {}", row_);
  throw InvalidInput(column.empty()
                         ? fmt::format("{}: {}: {}", name_, where, reason)
                         : fmt::format("{}: {}, column '{}': {}", name_, where, one_line(column, 60), reason));
}

}  // namespace grainlaw
