#pragma once
// A column of a table of rows, declared once: title, unit, symbol, meaning, access. Tables are lists of columns.

#include <string>
#include <type_traits>
#include <vector>

#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

template <class Row>
struct Column {
  std::string name;           ///< title without unit
  std::string unit;           ///< empty: dimensionless
  std::string symbol;         ///< the paper's symbol
  std::string meaning;        ///< one line
  double (*get)(const Row&);  ///< NaN: undefined
  void (*set)(Row&, double);
  bool required = false;  ///< a data set that is to be fitted must have it

  std::string title() const { return unit.empty() ? name : name + "[" + unit + "]"; }  ///< as in the header line
};

template <class Row>
using Columns = std::vector<Column<Row>>;

// Column<Row> wants plain functions; the template argument carries the member, which may be inherited.
template <auto member, class Row>
double get_member(const Row& row) {
  return static_cast<double>(row.*member);
}
template <auto member, class Row>
void set_member(Row& row, double value) {
  row.*member = static_cast<std::remove_reference_t<decltype(row.*member)>>(value);
}

template <auto member, class Row>
void add(Columns<Row>& columns, const char* name, const char* unit, const char* symbol, const char* meaning,
         bool required = false) {
  columns.push_back({name, unit, symbol, meaning, &get_member<member, Row>, &set_member<member, Row>, required});
}

template <auto member, std::size_t k, class Row>
double get_component(const Row& row) {
  return (row.*member).tensor(kComponentIndex[k][0], kComponentIndex[k][1]);
}
template <auto member, std::size_t k, class Row>
void set_component(Row& row, double value) {
  (row.*member).tensor(kComponentIndex[k][0], kComponentIndex[k][1]) = value;
  (row.*member).tensor(kComponentIndex[k][1], kComponentIndex[k][0]) = value;
}

template <auto member, std::size_t k = 0, class Row>
void add_tensor(Columns<Row>& columns, const std::string& name, const std::string& unit, const std::string& symbol,
                const std::string& meaning, bool required = false) {
  const std::string suffix = kComponentName[k];
  columns.push_back({name + "_" + suffix, unit, symbol + "_" + suffix, meaning + ", component " + suffix,
                     &get_component<member, k, Row>, &set_component<member, k, Row>, required});
  if constexpr (k + 1 < kComponentName.size())
    add_tensor<member, k + 1, Row>(columns, name, unit, symbol, meaning, required);
}

}  // namespace grainlaw
