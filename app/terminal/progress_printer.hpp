#pragma once
// Progress of a list of jobs on stderr: one line that is rewritten on a terminal, a line every few seconds elsewhere,
// nothing when quiet. No colours.

#include <chrono>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "model/vocabulary/run_control.hpp"

namespace grainlaw::app {

class ProgressPrinter : public Watch {
 public:
  ProgressPrinter(std::FILE* out, bool quiet);

  void begin(const std::vector<double>& work, std::string unit) override;
  RunControl control(std::size_t job, std::string name, std::stop_token stop) override;
  void finished(std::size_t job) override;
  void end() override;                         ///< clears the line, too
  void log(const std::string& text) override;  ///< a line of its own

 private:
  struct Job {
    std::string name;
    double expected = 0;          // work of the whole job
    double work = 0;              // work done, that of an earlier session included
    std::optional<double> first;  // work at the first report of this session
    double fraction = 0;          // of the current stage
    std::string stage;
    bool running = false, done = false;
  };

  void report(std::size_t job, const Progress& progress);
  void write(const std::string& text);
  void print();
  void clear_line();
  std::string status() const;

  std::FILE* out_;
  bool quiet_, terminal_, line_shown_ = false;
  std::mutex mutex_;
  std::vector<Job> jobs_;
  std::string unit_;
  std::chrono::steady_clock::time_point began_, printed_;
};

/// "0:42", "1:02:03".
std::string clock_text(double seconds);

}  // namespace grainlaw::app
