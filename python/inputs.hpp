#pragma once
// What Python gives, as the library takes it: files, documents, numbers, names. Whatever is not what it should be is
// InvalidInput that names the argument and the key.

#include <pybind11/numpy.h>

#include <filesystem>
#include <string>

#include "model/files/json_document.hpp"
#include "model/vocabulary/enum_names.hpp"

namespace grainlaw::python {

/// Of str, bytes or os.PathLike.
std::filesystem::path file_of(pybind11::handle object, const std::string& name);

/// Likewise; empty for None.
std::filesystem::path file_or_none(pybind11::handle object, const std::string& name);

/// A document as a dict: with str keys, and values that are dicts, sequences, arrays and scalars of numpy, str, os.PathLike,
/// bool, None, finite numbers; whole ones count as integers, as in JsonSource::user.
Json document_of(pybind11::handle object, const std::string& name);

/// What read(file) or take(document, folder, name) makes of the argument: a dict, whose files are relative to the current
/// folder, or the path of a JSON file, whose files are relative to its own.
template <class Read, class Take>
auto given(pybind11::handle object, const std::string& name, const Read& read, const Take& take) {
  if (pybind11::isinstance<pybind11::dict>(object))
    return take(document_of(object, name), std::filesystem::path("."), name);
  return read(file_of(object, name));
}

std::int64_t whole_number(pybind11::handle object, const std::string& name, std::int64_t least, std::int64_t most);
double finite_number(pybind11::handle object, const std::string& name);
std::string text_of(pybind11::handle object, const std::string& name);

/// Of a name.
template <NamedEnum E>
E choice_of(pybind11::handle object, const char* name) {
  return value_of<E>(text_of(object, name), name);
}

/// Finite real numbers in the order of C, of `dimensions` dimensions. A copy only where they lie otherwise.
pybind11::array_t<double> numbers_of(pybind11::handle object, const std::string& name, int dimensions);

/// As Python's own objects.
pybind11::object to_python(const OrderedJson& json);

}  // namespace grainlaw::python
