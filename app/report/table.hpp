#pragma once
// A table as plain data: columns and rows of cells. A table is written as a list of columns, each with what it reads of an
// entry, and a range of entries; table_of() makes the cells. How it is drawn is left to page.hpp.

#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include "app/report/number_text.hpp"
#include "app/report/text.hpp"

namespace grainlaw::app::report {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

/// An estimate as a line from lower to upper with a mark at its value, beside a reference; NaN: not drawn.
struct Bar {
  double lower = kUndefined, value = kUndefined, upper = kUndefined, reference = kUndefined;
};

inline constexpr int kHeats = 5;  ///< shades of a heat map, from the best to the worst

/// What a reader sees, and the number behind it.
struct Cell {
  Text text;
  double value = kUndefined;    ///< before rounding, in the unit of the text; NaN where the cell shows words
  std::string link = {};        ///< id of the section, figure or table that has more; empty: none
  int heat = -1;                ///< shade, 0 to kHeats - 1; -1: none
  std::optional<Bar> bar = {};  ///< drawn in place of the text, which then is for readers without a picture

  Cell(Text words) : text(std::move(words)) {}
  Cell(const std::string& words) : text(plain(words)) {}
  Cell(const char* words) : text(plain(words)) {}
  Cell(std::integral auto count) : text(plain(std::to_string(count))), value(static_cast<double>(count)) {}
  Cell(const std::string& words, double number, int shade = -1) : text(plain(words)), value(number), heat(shade) {}
};

enum class Content { words, symbol, number };  ///< of a column: may wrap, may not, aligned to the right

struct TableColumn {
  Text heading;  ///< with its unit in brackets
  Content content = Content::number;
};

struct Table {
  std::string caption;  ///< one line, above the table
  std::vector<TableColumn> columns;
  std::vector<std::vector<Cell>> rows;  ///< as many cells as columns
  std::string source;                   ///< file, may be empty
  std::string id = {};                  ///< letters, digits and '-'; empty: nothing links to it
  std::vector<std::string> notes = {};  ///< beneath the rows, as many or none; empty: no note
  double bar_from = 0, bar_to = 1;      ///< range of the bars
};

/// Numbers as cells: with significant digits, with decimals, with a standard error.
inline Cell digits(double value, int count = 4) { return {significant(value, count), value}; }
inline Cell decimals(double value, int count) { return {fixed(value, count), value}; }
inline Cell measured(double value, double standard_error) { return {with_error(value, standard_error), value}; }

/// A column of a table about entries.
template <class Entry>
struct ColumnOf {
  const char* heading;  ///< in the notation of text.hpp
  Content content;
  std::function<Cell(const Entry&)> cell;
};

/// A row for each of `entries`.
template <class Entries, class Entry = std::ranges::range_value_t<Entries>>
Table table_of(std::string caption, std::string source, Entries&& entries,
               const std::vector<ColumnOf<Entry>>& columns) {
  Table table{std::move(caption), {}, {}, std::move(source)};
  for (const ColumnOf<Entry>& column : columns) table.columns.push_back({notation(column.heading), column.content});
  for (const Entry& entry : entries) {
    std::vector<Cell>& row = table.rows.emplace_back();
    for (const ColumnOf<Entry>& column : columns) row.push_back(column.cell(entry));
  }
  return table;
}

/// An entry of a list that belongs to another entry.
template <class Outer, class Inner>
struct Within {
  const Outer& in;
  const Inner& it;
};

/// Every entry of `list_of(outer)` that `keep` accepts, for every one of `outers`, which must outlive them.
template <class Outer, class ListOf, class Keep>
auto each_within(const std::vector<Outer>& outers, const ListOf& list_of, const Keep& keep) {
  using Inner = std::ranges::range_value_t<std::invoke_result_t<const ListOf&, const Outer&>>;
  std::vector<Within<Outer, Inner>> entries;
  for (const Outer& outer : outers) {
    for (const Inner& inner : std::invoke(list_of, outer)) {
      if (const Within<Outer, Inner> entry{outer, inner}; keep(entry)) entries.push_back(entry);
    }
  }
  return entries;
}
template <class Outer, class ListOf>
auto each_within(const std::vector<Outer>& outers, const ListOf& list_of) {
  return each_within(outers, list_of, [](const auto&) { return true; });
}

}  // namespace grainlaw::app::report
