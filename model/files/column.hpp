#pragma once
// The columns of a table of rows, which follow from the fields of the row (model/vocabulary/fields.hpp): one for each
// number, six for each tensor, also for a deviator; and tables of such rows as CSV: the same table of fields writes and
// reads.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/fields.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

template <class Row>
struct Column {
  std::string name;     ///< title without unit
  std::string unit;     ///< empty: dimensionless
  std::string symbol;   ///< the paper's symbol
  std::string meaning;  ///< one line
  Rule rule = Rule::plain;
  bool whole = false;                     ///< an integer or yes and no, never undefined
  std::function<double(const Row&)> get;  ///< NaN: undefined
  std::function<void(Row&, double)> set;

  std::string title() const { return unit.empty() ? name : name + "[" + unit + "]"; }  ///< as in the header line
  bool required() const { return rule != Rule::plain; }                                ///< a file must have the column
  bool defined() const { return whole || rule == Rule::needed_number; }                ///< with a number in every row
};

/// Component k of a symmetric tensor, both places of it when set.
inline double component(const Eigen::Matrix3d& a, std::size_t k) {
  return a(kComponentIndex[k][0], kComponentIndex[k][1]);
}
inline void set_component(Eigen::Matrix3d& a, std::size_t k, double value) {
  a(kComponentIndex[k][0], kComponentIndex[k][1]) = a(kComponentIndex[k][1], kComponentIndex[k][0]) = value;
}
/// Of the tensor of a deviator. Its diagonal arrives as xx, yy, zz: the last one follows from the trace and is not set.
inline double component(const Deviator<double>& q, std::size_t k) { return component(tensor_of<double>(q), k); }
inline void set_component(Deviator<double>& q, std::size_t k, double value) {
  if (k == 2) return;
  Eigen::Matrix3d a = tensor_of<double>(q);
  set_component(a, k, value);
  a(2, 2) = -a(0, 0) - a(1, 1);
  q = deviator<double>(a);
}
template <class Tensor>
double component(const Tensor& a, std::size_t k) {
  return component(a.tensor, k);
}
template <class Tensor>
void set_component(Tensor& a, std::size_t k, double value) {
  set_component(a.tensor, k, value);
}

/// In the order of the fields, which is that of writing.
template <class Row>
const std::vector<Column<Row>>& columns_of() {
  static const std::vector<Column<Row>> all = [] {
    std::vector<Column<Row>> columns;
    for_each_field<Row>([&](const auto& field) {
      using Value = ValueOf<Row, decltype(field.access)>;
      const auto access = field.access;
      if constexpr (std::is_arithmetic_v<Value>) {
        columns.push_back({field.name, field.unit, field.symbol, field.meaning, field.rule, std::is_integral_v<Value>,
                           [access](const Row& row) { return static_cast<double>(std::invoke(access, row)); },
                           [access](Row& row, double value) { std::invoke(access, row) = static_cast<Value>(value); }});
      } else {
        for (std::size_t k = 0; k < kComponentName.size(); ++k) {
          const std::string suffix = kComponentName[k];
          columns.push_back(
              {std::string(field.name) + "_" + suffix, field.unit, std::string(field.symbol) + "_" + suffix,
               std::string(field.meaning) + ", component " + suffix, field.rule, false,
               [access, k](const Row& row) { return component(std::invoke(access, row), k); },
               [access, k](Row& row, double value) { set_component(std::invoke(access, row), k, value); }});
        }
      }
    });
    return columns;
  }();
  return all;
}

/// The first column of `row` that holds an infinite number, which no file takes: products of given numbers may be too large
/// for one. Null without.
template <class Row>
const Column<Row>* infinite_column(const Row& row) {
  const auto& columns = columns_of<Row>();
  const auto column =
      std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return std::isinf(c.get(row)); });
  return column == columns.end() ? nullptr : &*column;
}

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

/// Puts a value into its place in the row; refuses an empty field where there must be a number, and a broken or huge one where
/// it must be whole.
template <class Row>
void set_value(const CsvReader& reader, Row& row, const Column<Row>& column, double value) {
  if (std::isnan(value) && column.defined())
    reader.refuse(column.title(), "is empty; this column needs a number in every row");
  if (column.whole && !(value == std::trunc(value) && std::abs(value) <= std::numeric_limits<int>::max()))
    reader.refuse(column.title(), fmt::format("is {}; this column needs a whole number", value));
  column.set(row, value);
}

}  // namespace grainlaw
