#include "dem/thread_team.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "model/error.hpp"

namespace grainlaw::dem {
namespace {

// Loops are some tens of microseconds long, so the crew spins for about as long before it sleeps.
constexpr int kSpins = 2000;

}  // namespace

struct ThreadTeam::Crew {
  std::vector<std::thread> threads;
  std::atomic<std::uint64_t> round{0};     // grows by one per loop; workers wait for it
  std::atomic<int> busy{0};                // workers that have not finished the current loop
  std::atomic<std::size_t> next_block{0};
  std::size_t blocks = 0;
  const std::function<void(std::size_t)>* body = nullptr;
  std::mutex failure_mutex;
  std::exception_ptr failure;
  bool quit = false;

  void work() {
    try {
      for (std::size_t b = next_block++; b < blocks; b = next_block++) (*body)(b);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next_block = blocks;
    }
  }

  void worker() {
    std::uint64_t seen = 0;
    for (;;) {
      for (int spin = 0; spin < kSpins && round.load() == seen; ++spin) std::this_thread::yield();
      round.wait(seen);
      seen = round.load();
      if (quit) return;
      work();
      if (--busy == 0) busy.notify_one();
    }
  }

  void start_round() {
    ++round;
    round.notify_all();
  }
};

ThreadTeam::ThreadTeam(int threads) : crew_(std::make_unique<Crew>()) {
  if (threads < 1) throw InvalidInput("threads: must be at least 1");
  for (int i = 1; i < threads; ++i) crew_->threads.emplace_back([crew = crew_.get()] { crew->worker(); });
}

ThreadTeam::~ThreadTeam() {
  crew_->quit = true;
  crew_->start_round();
  for (std::thread& thread : crew_->threads) thread.join();
}

int ThreadTeam::threads() const { return static_cast<int>(crew_->threads.size()) + 1; }

void ThreadTeam::for_each_block(std::size_t blocks, const std::function<void(std::size_t)>& body) {
  Crew& crew = *crew_;
  if (crew.threads.empty() || blocks <= 1) {
    for (std::size_t b = 0; b < blocks; ++b) body(b);
    return;
  }
  crew.blocks = blocks;
  crew.body = &body;
  crew.next_block = 0;
  crew.busy = static_cast<int>(crew.threads.size());
  crew.start_round();
  crew.work();
  for (int spin = 0; spin < kSpins && crew.busy.load() != 0; ++spin) std::this_thread::yield();
  for (int left = crew.busy.load(); left != 0; left = crew.busy.load()) crew.busy.wait(left);
  if (crew.failure) std::rethrow_exception(std::exchange(crew.failure, nullptr));
}

}  // namespace grainlaw::dem
