#pragma once
// Long work for Python: on a thread of its own, without the interpreter's lock. The calling thread looks a few times a second
// for signals and tells of progress, so that all that is Python happens in the thread that called.

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>

#include "model/files/execution.hpp"

namespace grainlaw::python {

/// How a call is to be carried out, as its keyword arguments say.
struct Wishes {
  pybind11::object threads = pybind11::none();   ///< None: all cores
  pybind11::object progress = pybind11::none();  ///< callable(fraction, text), or None
  bool resume = true;                            ///< as in Execution
  std::string command = "python";                ///< for the provenance of files
};

/// Calls work(execution), which must not touch Python. Its messages go to the logger "grainlaw". When a signal's handler or
/// `progress` raises, the work is asked to stop; what was raised is thrown when it has, KeyboardInterrupt as Interrupted.
void carry_out(const Wishes& wishes, const std::function<void(const Execution&)>& work);

/// What `work` returns, likewise.
template <class Work>
auto result_of(const Wishes& wishes, const Work& work) {
  std::optional<decltype(work(std::declval<const Execution&>()))> result;
  carry_out(wishes, [&](const Execution& execution) { result.emplace(work(execution)); });
  return std::move(*result);
}

}  // namespace grainlaw::python
