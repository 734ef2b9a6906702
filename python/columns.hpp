#pragma once
// A series as Python reads it: by the names of the CSV's columns, each a read-only array that looks straight into the rows and
// keeps them alive. The rows are structs, so an array steps over them; nothing is copied but the components of deviators, which
// are stored in other coordinates (model/vocabulary/tensor.hpp) and computed when asked for.

#include <pybind11/numpy.h>

#include <string>
#include <string_view>
#include <vector>

#include "model/files/column.hpp"

namespace grainlaw::python {

/// Over one number of each row, `first` that of the first. Read-only for good: `owner` lends no buffer.
template <class Number>
pybind11::array looking_at(const Number* first, std::vector<pybind11::ssize_t> shape,
                           std::vector<pybind11::ssize_t> strides, pybind11::handle owner) {
  pybind11::array array(pybind11::dtype::of<Number>(), std::move(shape), std::move(strides), first, owner);
  pybind11::detail::array_proxy(array.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// The component in `name`, "FIELD_xx"; none when it is another.
inline std::optional<std::size_t> component_in(std::string_view name, std::string_view field) {
  if (name.size() != field.size() + 3 || !name.starts_with(field) || name[field.size()] != '_') return std::nullopt;
  const auto found = std::ranges::find(kComponentName, name.substr(field.size() + 1));
  if (found == kComponentName.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kComponentName.begin());
}

/// Column `name` without its unit, or a whole tensor as (rows, 3, 3); null when there is none of that name.
template <class Row>
pybind11::object column_of(const std::vector<Row>& rows, std::string_view name, pybind11::handle owner) {
  using pybind11::ssize_t;
  static const Row nothing{};
  const Row& first = rows.empty() ? nothing : rows.front();
  const auto count = static_cast<ssize_t>(rows.size());
  constexpr auto step = static_cast<ssize_t>(sizeof(Row));
  constexpr auto number = static_cast<ssize_t>(sizeof(double));
  pybind11::object column;
  for_each_field<Row>([&](const auto& field) {
    if (column || !name.starts_with(field.name)) return;
    const auto& value = std::invoke(field.access, first);
    const auto component_of_field = component_in(name, field.name);
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
      if (name == field.name) column = looking_at(&value, {count}, {step}, owner);
    } else if constexpr (requires { value.tensor; }) {
      if (name == field.name)
        column = looking_at(value.tensor.data(), {count, 3, 3}, {step, number, 3 * number}, owner);
      if (!component_of_field) return;
      const auto [i, j] = kComponentIndex[*component_of_field];
      column = looking_at(&value.tensor(i, j), {count}, {step}, owner);
    } else if (component_of_field) {
      pybind11::array_t<double> computed(count);
      for (std::size_t i = 0; i < rows.size(); ++i)
        computed.mutable_at(static_cast<ssize_t>(i)) =
            component(std::invoke(field.access, rows[i]), *component_of_field);
      computed.attr("flags").attr("writeable") = false;
      column = std::move(computed);
    }
  });
  return column;
}

template <class Row>
pybind11::list names_of_columns() {
  pybind11::list names;
  for (const auto& column : columns_of<Row>()) names.append(column.name);
  return names;
}

/// Makes `type` a mapping from names to columns, which are attributes, too; rows_of(const T&) gives the rows.
template <class Row, class T, class... More, class RowsOf>
void add_columns(pybind11::class_<T, More...>& type, const RowsOf& rows_of) {
  namespace py = pybind11;
  const auto look_up = [rows_of](const py::object& self, const std::string& name) {
    return column_of(rows_of(self.cast<const T&>()), name, self);
  };
  type.def("keys", [](const T&) { return names_of_columns<Row>(); })
      .def("__iter__", [](const T&) { return py::iter(names_of_columns<Row>()); })
      .def("__len__", [](const T&) { return columns_of<Row>().size(); })
      .def("__contains__", [](const T&, const py::object& name) { return names_of_columns<Row>().contains(name); })
      .def("__getitem__",
           [look_up](const py::object& self, const std::string& name) {
             py::object column = look_up(self, name);
             if (!column) throw py::key_error(name);
             return column;
           })
      .def("__getattr__",
           [look_up](const py::object& self, const std::string& name) {
             py::object column = look_up(self, name);
             if (!column) throw py::attribute_error(name);
             return column;
           })
      .def("__dir__",
           [](const py::object& self) {
             py::list names = py::module_::import("builtins").attr("object").attr("__dir__")(self);
             for (const auto& name : names_of_columns<Row>()) names.append(name);
             return names;
           })
      .def_property_readonly("rows", [rows_of](const T& self) { return rows_of(self).size(); })
      .def_property_readonly_static("units", [](const py::object&) {
        py::dict units;
        for (const auto& column : columns_of<Row>()) units[py::str(column.name)] = column.unit;
        return units;
      });
}

}  // namespace grainlaw::python
