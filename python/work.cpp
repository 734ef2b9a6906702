#include "python/work.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "model/vocabulary/error.hpp"
#include "python/errors.hpp"
#include "python/inputs.hpp"
#include "python/progress_record.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;

constexpr auto kInterval = std::chrono::milliseconds(100);  // between two looks at signals

int threads_of(const py::object& threads) {
  if (threads.is_none()) return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  return static_cast<int>(whole_number(threads, "threads", 1, 1024));
}

/// What there is to tell, to those who listen. Throws what they raise.
void tell(ProgressRecord& record, const py::object& progress, std::pair<double, std::string>& told) {
  for (const std::string& message : record.messages())
    py::module_::import("logging").attr("getLogger")("grainlaw").attr("warning")("%s", message);
  if (progress.is_none()) return;
  auto status = record.status();
  if (status == told) return;
  told = status;
  progress(status.first, status.second);
}

}  // namespace

void carry_out(const Wishes& wishes, const std::function<void(const Execution&)>& work) {
  if (!wishes.progress.is_none() && PyCallable_Check(wishes.progress.ptr()) == 0)
    throw InvalidInput("progress: is not callable; give a function of (fraction, text)");
  ProgressRecord record;
  std::stop_source stop;
  const Execution execution{.threads = threads_of(wishes.threads),
                            .stop = stop.get_token(),
                            .watch = record,
                            .resume = wishes.resume,
                            .command = wishes.command};
  std::mutex mutex;
  std::condition_variable ends;
  bool ended = false;
  std::exception_ptr failure;
  std::jthread worker([&] {
    try {
      work(execution);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    ended = true;
    ends.notify_one();
  });
  const auto wait = [&] {
    const py::gil_scoped_release unlocked;
    std::unique_lock lock(mutex);
    return ends.wait_for(lock, kInterval, [&] { return ended; });
  };
  std::optional<py::error_already_set> raised;
  std::pair<double, std::string> told{-1, ""};
  for (bool done = false; !done;) {
    done = wait();
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      tell(record, wishes.progress, told);
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
      stop.request_stop();
    }
  }
  worker.join();
  if (raised && !raised->matches(PyExc_KeyboardInterrupt)) throw py::error_already_set(std::move(*raised));
  std::string what = "interrupted when all was done; the results are on disk";
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    if (!raised) throw;
    what = error.what();
  }
  if (raised) raise_interrupted(*raised, what);
}

}  // namespace grainlaw::python
