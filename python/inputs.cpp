#include "python/inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <new>

#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;

constexpr double kLargestWhole = 9.0e18;  // as in JsonSource::user

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw InvalidInput(fmt::format("{}: {}", name, why));
}

std::string type_of(py::handle object) { return Py_TYPE(object.ptr())->tp_name; }

/// For messages; a repr may fail, as that of integers of many digits does.
std::string shown(py::handle object) {
  const auto text = py::reinterpret_steal<py::object>(PyObject_Repr(object.ptr()));
  if (text) return one_line(std::string(py::str(text)), 60);
  PyErr_Clear();
  return "a " + type_of(object);
}

bool is_numpys(py::handle object) { return py::hasattr(object, "dtype") && py::hasattr(object, "tolist"); }

Json number_from(py::handle object, const std::string& name) {
  if (PyLong_Check(object.ptr())) {
    int overflow = 0;
    const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
    if (overflow == 0) return value;
    const unsigned long long large = overflow > 0 ? PyLong_AsUnsignedLongLong(object.ptr()) : 0;
    if (overflow < 0 || PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      refuse(name, "is beyond the range of integers; give a smaller one");
    }
    return large;
  }
  const double value = PyFloat_AsDouble(object.ptr());
  if (!std::isfinite(value)) refuse(name, fmt::format("{} is not finite; give a number", value));
  if (value == std::trunc(value) && std::abs(value) < kLargestWhole) return static_cast<std::int64_t>(value);
  return value;
}

Json value_from(py::handle object, const std::string& name, int depth) {
  if (depth > kMaxJsonDepth) refuse(name, fmt::format("is nested deeper than {} levels; flatten it", kMaxJsonDepth));
  if (object.is_none()) return nullptr;
  if (PyBool_Check(object.ptr())) return object.ptr() == Py_True;
  if (PyUnicode_Check(object.ptr())) return text_of(object, name);
  if (PyLong_Check(object.ptr()) || PyFloat_Check(object.ptr())) return number_from(object, name);
  if (py::isinstance<py::dict>(object)) {
    Json json = Json::object();
    for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(object)) {
      const std::string text = text_of(key, name + ": a key");
      json[text] =
          value_from(value, fmt::format("{}{}{}", name, depth == 0 ? ": " : ".", one_line(text, 40)), depth + 1);
    }
    return json;
  }
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
    Json json = Json::array();
    for (const auto& value : py::reinterpret_borrow<py::sequence>(object))
      json.push_back(value_from(value, fmt::format("{}[{}]", name, json.size()), depth + 1));
    return json;
  }
  if (is_numpys(object)) return value_from(object.attr("tolist")(), name, depth + 1);
  if (py::hasattr(object, "__fspath__")) return file_of(object, name).string();
  refuse(name,
         fmt::format("is of type {}, which no document holds; give numbers, text, lists or dicts", type_of(object)));
}

}  // namespace

std::filesystem::path file_of(py::handle object, const std::string& name) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(object.ptr(), &bytes) == 0) {
    const py::error_already_set raised;
    if (!raised.matches(PyExc_TypeError))
      refuse(name, one_line(std::string(py::str(raised.value())), 200) + " in the path of a file");
    refuse(name, fmt::format("is of type {}; give the path of a file as str, bytes or os.PathLike", type_of(object)));
  }
  const std::string path = py::reinterpret_steal<py::bytes>(bytes);
  if (path.empty()) refuse(name, "is empty; give the path of a file");
  return path;
}

std::filesystem::path file_or_none(py::handle object, const std::string& name) {
  return object.is_none() ? std::filesystem::path() : file_of(object, name);
}

Json document_of(py::handle object, const std::string& name) { return value_from(object, name, 0); }

std::int64_t whole_number(py::handle object, const std::string& name, std::int64_t least, std::int64_t most) {
  const py::object index = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
  if (!index) PyErr_Clear();
  int overflow = 0;
  const long long value = index ? PyLong_AsLongLongAndOverflow(index.ptr(), &overflow) : 0;
  if (!index || PyBool_Check(object.ptr()) || overflow != 0 || value < least || value > most) {
    refuse(name, fmt::format("got {}; give an integer from {} to {}", shown(object), least, most));
  }
  return value;
}

double finite_number(py::handle object, const std::string& name) {
  const double value = PyFloat_AsDouble(object.ptr());
  const bool no_number = PyErr_Occurred() != nullptr;
  if (no_number) PyErr_Clear();
  if (no_number || PyBool_Check(object.ptr()) || !std::isfinite(value))
    refuse(name, fmt::format("got {}; give a finite number", shown(object)));
  return value;
}

std::string text_of(py::handle object, const std::string& name) {
  if (!PyUnicode_Check(object.ptr())) refuse(name, fmt::format("is of type {}; give a str", type_of(object)));
  Py_ssize_t size = 0;
  const char* text = PyUnicode_AsUTF8AndSize(object.ptr(), &size);
  if (text == nullptr) {
    PyErr_Clear();
    refuse(name, "holds characters that are no UTF-8; give plain text");
  }
  return {text, static_cast<std::size_t>(size)};
}

py::array_t<double> numbers_of(py::handle object, const std::string& name, int dimensions) {
  if (py::isinstance(object, py::module_::import("numpy.ma").attr("MaskedArray")))
    refuse(name, "is a masked array, whose mask would be lost; give a plain one");
  const auto given = py::array::ensure(object);
  if (!given) refuse(name, fmt::format("is no array; give one of numbers, got {}", shown(object)));
  const char kind = given.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    refuse(name, fmt::format("has the dtype {}; give real numbers", std::string(py::str(given.dtype()))));
  if (given.ndim() != dimensions) refuse(name, fmt::format("has {} dimensions; give {}", given.ndim(), dimensions));
  auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!numbers) throw std::bad_alloc();
  const double* data = numbers.data();
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(data[i])) {
      const py::object at = py::module_::import("numpy").attr("unravel_index")(i, numbers.attr("shape"));
      refuse(name, fmt::format("{} at {} is not finite; give numbers", data[i], std::string(py::str(at))));
    }
  }
  return numbers;
}

py::object to_python(const OrderedJson& json) { return py::module_::import("json").attr("loads")(json_text(json)); }

}  // namespace grainlaw::python
