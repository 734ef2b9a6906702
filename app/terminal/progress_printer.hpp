#pragma once
// Progress of a list of jobs on stderr: one line that is rewritten on a terminal, a line every few seconds elsewhere,
// nothing when quiet. No colours.

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "app/terminal/job_record.hpp"

namespace grainlaw::app {

class ProgressPrinter : public JobRecord {
 public:
  ProgressPrinter(std::FILE* out, bool quiet);

  void begin(const std::vector<double>& work, std::string unit) override;
  void end() override;                         ///< clears the line, too
  void log(const std::string& text) override;  ///< a line of its own

 private:
  void changed(bool finished) override;
  void write(const std::string& text);
  void print();
  void clear_line();
  std::string status() const;

  std::FILE* out_;
  bool quiet_, terminal_, line_shown_ = false;
  std::chrono::steady_clock::time_point began_, printed_;
};

/// "0:42", "1:02:03".
std::string clock_text(double seconds);

}  // namespace grainlaw::app
