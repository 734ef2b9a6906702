#include "dem/runs/job_list.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "dem/engine/run_watch.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

enum class Phase { waiting, elsewhere, running, done };

class Schedule {
 public:
  Schedule(const std::vector<Job>& jobs, int threads, Watch& watch, const std::stop_token& stop)
      : jobs_(jobs),
        watch_(watch),
        phase_(jobs.size(), Phase::waiting),
        ask_again_(jobs.size()),
        errors_(jobs.size()),
        patience_(std::chrono::milliseconds(1000 + jobs.size())),  // gentle with the file system of many
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
      const bool elsewhere = std::find(phase_.begin(), phase_.end(), Phase::elsewhere) != phase_.end();
      if (running_ == 0 && (!elsewhere || all_.stop_requested())) break;
      if (elsewhere && free_ > 0 && !all_.stop_requested())
        changed_.wait_until(lock, Clock::now() + patience_);
      else
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
    if (phase_[i] == Phase::elsewhere) return Clock::now() >= ask_again_[i];
    return phase_[i] == Phase::waiting && (!jobs_[i].after || phase_[*jobs_[i].after] == Phase::done);
  }

  /// Starts a job, or finds that one need not be; false when there is none.
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
    const Claim claim = claimed(next);
    if (claim == Claim::elsewhere) ask_later(next);
    if (claim == Claim::finished) phase_[next] = Phase::done;
    if (claim != Claim::mine) return true;
    const int threads = std::max(1, free_ / waiting);
    try {
      workers_.emplace_back([this, next, threads] { work(next, threads); });
    } catch (...) {  // no thread, no memory: those that run need not go on
      errors_[next] = std::current_exception();
      all_.request_stop();
      return false;
    }
    free_ -= threads;
    ++running_;
    phase_[next] = Phase::running;
    return true;
  }

  Claim claimed(std::size_t i) {
    try {
      const Claim claim = jobs_[i].claim ? jobs_[i].claim() : Claim::mine;
      if (claim == Claim::finished) watch_.finished(i);
      return claim;
    } catch (...) {
      errors_[i] = std::current_exception();
      all_.request_stop();
      return Claim::finished;
    }
  }

  void ask_later(std::size_t i) {
    phase_[i] = Phase::elsewhere;
    ask_again_[i] = Clock::now() + patience_;
  }

  void work(std::size_t i, int threads) {
    std::exception_ptr error;
    bool taken_over = false;
    try {
      jobs_[i].run(threads, watch_.control(i, jobs_[i].name, all_.get_token()));
      watch_.finished(i);
    } catch (const TakenOver&) {
      taken_over = true;
    } catch (...) {
      error = std::current_exception();
      all_.request_stop();
    }
    const std::lock_guard lock(mutex_);
    errors_[i] = error;
    phase_[i] = Phase::done;
    if (taken_over) ask_later(i);
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
  std::vector<Clock::time_point> ask_again_;
  std::vector<std::exception_ptr> errors_;
  Clock::duration patience_;
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
