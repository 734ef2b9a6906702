#include "dem/thread_team.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "model/error.hpp"

namespace grainlaw::dem {
namespace {

// Loops are some tens of microseconds long, so the crew waits awake for about as long, then lets others run, then sleeps.
constexpr int kSpins = 2000, kYields = 200;

template <class Done>
void pause_until(const Done& done) {
  for (int spin = 0; spin < kSpins && !done(); ++spin) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  for (int i = 0; i < kYields && !done(); ++i) std::this_thread::yield();
}

}  // namespace

struct ThreadTeam::Crew {
  std::vector<std::thread> threads;
  std::atomic<std::uint64_t> round{0};     // grows by one per loop; workers wait for it
  std::atomic<int> busy{0};                // workers that have not finished the current loop
  std::size_t blocks = 0;
  const std::function<void(std::size_t)>* body = nullptr;
  std::mutex failure_mutex;
  std::exception_ptr failure;
  bool quit = false;

  /// The share of one member: always the same blocks, so that their data stay in its caches.
  void work(std::size_t member) {
    const std::size_t members = threads.size() + 1;
    try {
      for (std::size_t b = blocks * member / members; b < blocks * (member + 1) / members; ++b) (*body)(b);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  }

  void worker(std::size_t member) {
    std::uint64_t seen = 0;
    for (;;) {
      pause_until([&] { return round.load() != seen; });
      round.wait(seen);
      seen = round.load();
      if (quit) return;
      work(member);
      if (--busy == 0) busy.notify_one();
    }
  }

  void start_round() {
    ++round;
    round.notify_all();
  }

  void dismiss() {
    quit = true;
    start_round();
    for (std::thread& thread : threads) {
      if (thread.joinable()) thread.join();
    }
  }
};

ThreadTeam::ThreadTeam(int threads) : crew_(std::make_unique<Crew>()) {
  if (threads < 1) throw InvalidInput("threads: must be at least 1");
  crew_->threads.resize(static_cast<std::size_t>(threads - 1));
  try {
    for (std::size_t i = 0; i < crew_->threads.size(); ++i) {
      crew_->threads[i] = std::thread([crew = crew_.get(), i] { crew->worker(i + 1); });
    }
  } catch (const std::system_error&) {
    crew_->dismiss();
    throw Error("threads: the system does not start as many as " + std::to_string(threads) + "; give fewer");
  }
}

ThreadTeam::~ThreadTeam() { crew_->dismiss(); }

int ThreadTeam::threads() const { return static_cast<int>(crew_->threads.size()) + 1; }

void ThreadTeam::for_each_block(std::size_t blocks, const std::function<void(std::size_t)>& body) {
  Crew& crew = *crew_;
  if (crew.threads.empty() || blocks <= 1) {
    for (std::size_t b = 0; b < blocks; ++b) body(b);
    return;
  }
  crew.blocks = blocks;
  crew.body = &body;
  crew.busy = static_cast<int>(crew.threads.size());
  crew.start_round();
  crew.work(0);
  pause_until([&] { return crew.busy.load() == 0; });
  for (int left = crew.busy.load(); left != 0; left = crew.busy.load()) crew.busy.wait(left);
  if (crew.failure) std::rethrow_exception(std::exchange(crew.failure, nullptr));
}

}  // namespace grainlaw::dem
