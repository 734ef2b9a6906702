#pragma once
// What jobs report, kept until somebody asks. Written by the threads that compute, read by the one that waits for them.

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "model/vocabulary/run_control.hpp"

namespace grainlaw::python {

class ProgressRecord : public Watch {
 public:
  void begin(const std::vector<double>& work, std::string unit) override;
  RunControl control(std::size_t job, std::string name, std::stop_token stop) override;
  void finished(std::size_t job) override;
  void end() override;
  void log(const std::string& text) override;

  /// Done part of the present list of jobs [0..1], and what is being done, e.g. "seed 1 D2 0.70".
  std::pair<double, std::string> status();

  /// The messages since the last call, in their order.
  std::vector<std::string> messages();

 private:
  struct Job {
    std::string name, stage;
    double expected = 0, work = 0, fraction = 0;
    bool running = false, done = false;
  };

  std::mutex mutex_;
  std::vector<Job> jobs_;
  std::string unit_;
  std::vector<std::string> messages_;
};

}  // namespace grainlaw::python
