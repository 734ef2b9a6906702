#include "app/terminal/interrupt.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <thread>
#include <utility>

#include "app/exit_code.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

// timeout(1), mpirun and npm signal the process and its group: it gets one wish twice.
constexpr std::int64_t kOneWishNs = 500'000'000;

// A handler may only touch lock-free values: the time of the first signal (ns, 0 before it) and a descriptor.
std::atomic<std::int64_t> first_signal{0};
std::atomic<int> pipe_in{-1};

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

extern "C" void on_signal(int) {
  const int saved = errno;
  std::int64_t first = 0;
  if (const std::int64_t now = now_ns(); !first_signal.compare_exchange_strong(first, now)) {
    if (now - first >= kOneWishNs) _exit(static_cast<int>(ExitCode::interrupted));
    errno = saved;
    return;
  }
  const char signalled = 's';
  while (write(pipe_in, &signalled, 1) < 0 && errno == EINTR) {
  }
  errno = saved;
}

}  // namespace

struct InterruptGuard::Watch {
  std::stop_source source;
  int ends[2]{-1, -1};
  struct sigaction earlier_int {
  }, earlier_term{};
  std::jthread thread;

  ~Watch() {
    for (const int end : ends) {
      if (end >= 0) close(end);
    }
  }
};

InterruptGuard::InterruptGuard() : watch_(new Watch) {
  if (pipe2(watch_->ends, O_CLOEXEC) != 0)
    throw Error(fmt::format("signals: no pipe can be opened: {}", std::strerror(errno)));
  first_signal = 0;
  pipe_in = watch_->ends[1];
  // stop callbacks are no business of a signal handler: a thread requests the stop
  watch_->thread = std::jthread([watch = watch_.get()] {
    char message = 0;
    while (read(watch->ends[0], &message, 1) < 0 && errno == EINTR) {
    }
    if (message == 's') watch->source.request_stop();
  });
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // what waits, as the opening of a FIFO that nobody writes does, ends with EINTR
  sigaction(SIGINT, &action, &watch_->earlier_int);
  sigaction(SIGTERM, &action, &watch_->earlier_term);
}

InterruptGuard::~InterruptGuard() {
  if (first_signal == 0) {  // else the process is about to end, by its exit code and not by the second signal of the one wish
    sigaction(SIGINT, &watch_->earlier_int, nullptr);
    sigaction(SIGTERM, &watch_->earlier_term, nullptr);
  }
  pipe_in = -1;
  close(std::exchange(watch_->ends[1], -1));  // ends the thread's read, whatever happens to system calls
  watch_->thread.join();
}

std::stop_token InterruptGuard::token() const { return watch_->source.get_token(); }

}  // namespace grainlaw::app
