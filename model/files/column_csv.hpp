#pragma once
// Tables of rows as CSV by their columns (model/files/column.hpp): the same table of fields writes and reads.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/files/column.hpp"
#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"

namespace grainlaw {

/// The titles of the columns, or one row, without the end of the line.
template <class Row>
std::string csv_header() {
  std::string text;
  for (const auto& column : columns_of<Row>()) text.append(text.empty() ? "" : ",").append(column.title());
  return text;
}
template <class Row>
std::string csv_line(const Row& row) {
  std::string text;
  const auto& columns = columns_of<Row>();
  for (std::size_t i = 0; i < columns.size(); ++i)
    text.append(i == 0 ? "" : ",").append(csv_number(columns[i].get(row)));
  return text;
}

/// Header line and one line for each row.
template <class Row>
std::string table_text(const std::vector<Row>& rows) {
  std::string text = csv_header<Row>() + '\n';
  for (const Row& row : rows) text += csv_line(row) + '\n';
  return text;
}

/// Column of each title in the header. Refuses unknown titles and missing required ones.
template <class Row>
std::vector<const Column<Row>*> matched(const CsvReader& reader) {
  const auto& columns = columns_of<Row>();
  std::vector<const Column<Row>*> found;
  for (const std::string& title : reader.header()) {
    const std::string name = title.substr(0, title.find('['));
    const auto column = std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.name == name; });
    if (column == columns.end()) {
      reader.refuse("", fmt::format("unknown column '{}'; docs/formats.md lists the columns, remove the others",
                                    one_line(title, 60)));
    }
    if (column->title() != title) {
      reader.refuse("", fmt::format("column '{}' must be in its unit: '{}'", one_line(title, 60), column->title()));
    }
    found.push_back(&*column);
  }
  for (const auto& column : columns) {
    if (column.required() && std::find(found.begin(), found.end(), &column) == found.end()) {
      reader.refuse("", fmt::format("misses the column '{}' ({})", column.title(), column.meaning));
    }
  }
  return found;
}

/// Puts a value into its place in the row; refuses an empty field where there must be a number.
template <class Row>
void set_value(const CsvReader& reader, Row& row, const Column<Row>& column, double value) {
  if (std::isnan(value) && column.defined())
    reader.refuse(column.title(), "is empty; this column needs a number in every row");
  column.set(row, value);
}

}  // namespace grainlaw
