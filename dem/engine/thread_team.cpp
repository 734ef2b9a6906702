#include "dem/engine/thread_team.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "model/vocabulary/error.hpp"

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

/// Blocks that nobody has begun: [low half, high half). The owner takes the first, others the last.
class alignas(64) Share {
 public:
  void set(std::size_t first, std::size_t last) { range_.store(static_cast<std::uint64_t>(last) << 32U | first); }
  std::optional<std::size_t> take_first() {
    return take([](std::uint32_t& first, std::uint32_t&) { return first++; });
  }
  std::optional<std::size_t> take_last() {
    return take([](std::uint32_t&, std::uint32_t& last) { return --last; });
  }

 private:
  template <class Take>
  std::optional<std::size_t> take(const Take& one) {
    std::uint64_t seen = range_.load();
    for (;;) {
      auto first = static_cast<std::uint32_t>(seen), last = static_cast<std::uint32_t>(seen >> 32U);
      if (first >= last) return std::nullopt;
      const std::size_t block = one(first, last);
      if (range_.compare_exchange_weak(seen, static_cast<std::uint64_t>(last) << 32U | first)) return block;
    }
  }

  std::atomic<std::uint64_t> range_{0};
};

}  // namespace

struct ThreadTeam::Crew {
  std::vector<std::thread> threads;
  std::vector<Share> shares;                               // of the members; the caller's is the first
  std::atomic<std::uint64_t> round{0};                     // grows by one per loop; workers wait for it
  std::atomic<std::size_t> unfinished{0};                  // blocks of the current loop
  const std::function<void(std::size_t)>* body = nullptr;  // to be read by who has taken a block
  std::mutex failure_mutex;
  std::exception_ptr failure;
  std::atomic<bool> quit{false};

  explicit Crew(std::size_t members) : shares(members) {}

  void run(std::size_t block) {
    try {
      (*body)(block);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  }

  /// One's own blocks, in each loop the same, so that their data stay in one's caches; then what slower members have left.
  void work(std::size_t member) {
    std::size_t done = 0;
    for (; const auto block = shares[member].take_first(); ++done) run(*block);
    for (std::size_t k = 1; k < shares.size(); ++k) {
      Share& other = shares[(member + k) % shares.size()];
      for (; const auto block = other.take_last(); ++done) run(*block);
    }
    if (done > 0 && unfinished.fetch_sub(done) == done) unfinished.notify_one();
  }

  void worker(std::size_t member) {
    std::uint64_t seen = 0;
    for (;;) {
      pause_until([&] { return round.load() != seen; });
      round.wait(seen);
      seen = round.load();
      if (quit) return;
      work(member);
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

ThreadTeam::ThreadTeam(int threads) {
  if (threads < 1) throw InvalidInput("threads: must be at least 1");
  crew_ = std::make_unique<Crew>(static_cast<std::size_t>(threads));
  crew_->threads.resize(static_cast<std::size_t>(threads - 1));
  try {
    for (std::size_t i = 0; i < crew_->threads.size(); ++i) {
      crew_->threads[i] = std::thread([crew = crew_.get(), i] { crew->worker(i + 1); });
    }
  } catch (const std::system_error&) {
    crew_->dismiss();
    throw Error("threads: the system does not start as many as " + std::to_string(threads) + "; give fewer");
  } catch (...) {  // no memory
    crew_->dismiss();
    throw;
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
  const std::size_t members = crew.shares.size();
  crew.body = &body;
  crew.unfinished = blocks;
  for (std::size_t m = 0; m < members; ++m) crew.shares[m].set(blocks * m / members, blocks * (m + 1) / members);
  crew.start_round();
  crew.work(0);
  pause_until([&] { return crew.unfinished.load() == 0; });
  for (std::size_t left = crew.unfinished.load(); left != 0; left = crew.unfinished.load()) crew.unfinished.wait(left);
  if (crew.failure) std::rethrow_exception(std::exchange(crew.failure, nullptr));
}

}  // namespace grainlaw::dem
