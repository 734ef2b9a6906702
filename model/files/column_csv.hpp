#pragma once
// Tables of rows as CSV by their columns: the same list of columns writes and reads.

#include <fmt/format.h>

#include <algorithm>

#include "model/files/column.hpp"
#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"

namespace grainlaw {

/// Header line and one line for each row.
template <class Row>
std::string table_text(const std::vector<Row>& rows, const std::vector<Column<Row>>& columns) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) text.append(i == 0 ? "" : ",").append(columns[i].title());
  text += '\n';
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      text.append(i == 0 ? "" : ",").append(csv_number(columns[i].get(row)));
    text += '\n';
  }
  return text;
}

/// Column of each title in the header. Refuses unknown titles and missing required ones.
template <class Row>
std::vector<const Column<Row>*> matched(const CsvReader& reader, const std::vector<Column<Row>>& columns) {
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
    if (column.required && std::find(found.begin(), found.end(), &column) == found.end()) {
      reader.refuse("", fmt::format("misses the column '{}' ({})", column.title(), column.meaning));
    }
  }
  return found;
}

}  // namespace grainlaw
