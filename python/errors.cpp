#include "python/errors.hpp"

#include <system_error>

#include "app/exit_code.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;

// Classes live as long as the interpreter.
PyObject *error = nullptr, *invalid_input = nullptr, *not_converged = nullptr, *interrupted = nullptr;

PyObject* add(py::module_& module, const char* name, const py::object& bases, app::ExitCode code, const char* doc) {
  const py::dict members(py::arg("exit_code") = static_cast<int>(code));
  PyObject* made =
      PyErr_NewExceptionWithDoc((std::string("grainlaw.") + name).c_str(), doc, bases.ptr(), members.ptr());
  if (made == nullptr) throw py::error_already_set();
  module.attr(name) = py::handle(made);
  return made;
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InvalidInput& e) {
    PyErr_SetString(invalid_input, e.what());
  } catch (const NotConverged& e) {
    PyErr_SetString(not_converged, e.what());
  } catch (const Interrupted& e) {
    PyErr_SetString(interrupted, e.what());
  } catch (const Error& e) {
    PyErr_SetString(error, e.what());
  } catch (const std::system_error& e) {  // also of the file system
    PyErr_SetString(error, e.what());
  }
}

}  // namespace

void add_errors(py::module_& module) {
  const auto known = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
  error = add(module, "Error", known(PyExc_RuntimeError), app::ExitCode::failure, "A computation failed.");
  invalid_input = add(module, "InvalidInput", py::make_tuple(known(error), known(PyExc_ValueError)),
                      app::ExitCode::invalid_input, "What was given is not valid: file, key or row, reason, remedy.");
  not_converged = add(module, "NotConverged", known(error), app::ExitCode::not_converged,
                      "An iteration ended without meeting its criterion. Of calibrate, `result` has what there is.");
  interrupted = add(module, "Interrupted", known(PyExc_KeyboardInterrupt), app::ExitCode::interrupted,
                    "Asked to stop; what was finished is on disk and found again by the same call.");
  py::register_exception_translator(translate);
}

void raise_interrupted(py::error_already_set& cause, const std::string& what) {
  py::raise_from(cause, interrupted, what.c_str());
  throw py::error_already_set();
}

void raise_not_converged(const std::string& what, const py::object& result) {
  const py::object raised = py::reinterpret_borrow<py::object>(not_converged)(what);
  raised.attr("result") = result;
  PyErr_SetObject(not_converged, raised.ptr());
  throw py::error_already_set();
}

}  // namespace grainlaw::python
