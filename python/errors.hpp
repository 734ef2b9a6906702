#pragma once
// The exit codes of the program as classes of exceptions, in Python's own hierarchy:
//   Error(RuntimeError) 1, InvalidInput(Error, ValueError) 2, NotConverged(Error) 3, Interrupted(KeyboardInterrupt) 130

#include <pybind11/pybind11.h>

#include <string>

namespace grainlaw::python {

/// Adds the classes to the module, and has what the library throws arrive as them.
void add_errors(pybind11::module_& module);

/// Throws Interrupted saying `what`, raised from `cause`.
[[noreturn]] void raise_interrupted(pybind11::error_already_set& cause, const std::string& what);

/// Throws NotConverged saying `what`, with what there is nevertheless as its attribute `result`.
[[noreturn]] void raise_not_converged(const std::string& what, const pybind11::object& result);

}  // namespace grainlaw::python
