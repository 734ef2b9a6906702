#include "dem/runs/job_list.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

enum class Phase { waiting, running, done };

class Schedule {
 public:
  Schedule(const std::vector<Job>& jobs, int threads, Watch& watch, const std::stop_token& stop)
      : jobs_(jobs),
        watch_(watch),
        phase_(jobs.size(), Phase::waiting),
        errors_(jobs.size()),
        free_(threads),
        forward_stop_(stop, [this] {
          all_.request_stop();
          const std::lock_guard lock(mutex_);  // not between a waiter's look and its sleep
          changed_.notify_all();
        }) {}

  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      while (!all_.stop_requested() && start_next()) {
      }
      if (running_ == 0) break;
      changed_.wait(lock);
    }
    lock.unlock();
    workers_.clear();  // joins
    for (const std::exception_ptr& error : errors_) rethrow_unless_interrupted(error);
    if (all_.stop_requested())
      throw Interrupted("interrupted; finished runs and checkpoints are kept, the same command goes on from there");
  }

 private:
  bool ready(std::size_t i) const {
    return phase_[i] == Phase::waiting && (!jobs_[i].after || phase_[*jobs_[i].after] == Phase::done);
  }

  bool start_next() {
    if (free_ == 0) return false;
    std::size_t next = jobs_.size();
    int waiting = 0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (!ready(i)) continue;
      if (next == jobs_.size()) next = i;
      ++waiting;
    }
    if (next == jobs_.size()) return false;
    const int threads = std::max(1, free_ / waiting);
    free_ -= threads;
    ++running_;
    phase_[next] = Phase::running;
    workers_.emplace_back([this, next, threads] { work(next, threads); });
    return true;
  }

  void work(std::size_t i, int threads) {
    std::exception_ptr error;
    try {
      jobs_[i].run(threads, watch_.control(i, jobs_[i].name, all_.get_token()));
      watch_.finished(i);
    } catch (...) {
      error = std::current_exception();
      all_.request_stop();
    }
    const std::lock_guard lock(mutex_);
    errors_[i] = error;
    phase_[i] = Phase::done;
    free_ += threads;
    --running_;
    changed_.notify_all();
  }

  static void rethrow_unless_interrupted(const std::exception_ptr& error) {
    if (!error) return;
    try {
      std::rethrow_exception(error);
    } catch (const Interrupted&) {
      // a consequence of another error or of the user's wish, reported by run()
    }
  }

  const std::vector<Job>& jobs_;
  Watch& watch_;
  std::vector<Phase> phase_;
  std::vector<std::exception_ptr> errors_;
  int free_, running_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::stop_source all_;
  std::stop_callback<std::function<void()>> forward_stop_;
  std::vector<std::jthread> workers_;
};

}  // namespace

void run_jobs(const std::vector<Job>& jobs, int threads, Watch& watch, const std::stop_token& stop) {
  std::vector<double> work;
  for (const Job& job : jobs) work.push_back(job.work);
  watch.begin(work, "particle-steps");
  try {
    Schedule(jobs, threads, watch, stop).run();
  } catch (...) {
    watch.end();
    throw;
  }
  watch.end();
}

}  // namespace grainlaw::dem
