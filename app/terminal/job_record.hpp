#pragma once
// A list of jobs as their reports tell of it: what is planned, running, done. Who shows it derives from it.

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "model/vocabulary/run_control.hpp"

namespace grainlaw::app {

class JobRecord : public Watch {
 public:
  void begin(const std::vector<double>& work, std::string unit) override;
  RunControl control(std::size_t job, std::string name, std::stop_token stop) override;
  void finished(std::size_t job) override;

 protected:
  struct Job {
    std::string name;
    double expected = 0;          // work of the whole job
    double work = 0;              // work done, that of an earlier session included
    std::optional<double> first;  // work at the first report of this session
    double fraction = 0;          // of the current stage
    std::string stage;
    bool running = false, done = false;
  };

  /// Called with mutex_ held after a job has reported or, `finished`, has ended.
  virtual void changed(bool finished) = 0;

  /// Work done by the job as it counts for the share of the whole, below what is expected until it has ended.
  double covered(const Job& job) const;

  std::mutex mutex_;
  std::vector<Job> jobs_;
  std::string unit_;
};

}  // namespace grainlaw::app
