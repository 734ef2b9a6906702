#pragma once
// What jobs report, kept until somebody asks. Written by the threads that compute, read by the one that waits for them.

#include <string>
#include <utility>
#include <vector>

#include "app/terminal/job_record.hpp"

namespace grainlaw::python {

class ProgressRecord : public app::JobRecord {
 public:
  void end() override;
  void log(const std::string& text) override;

  /// Done part of the present list of jobs [0..1], and what is being done, e.g. "seed 1 D2 0.70".
  std::pair<double, std::string> status();

  /// The messages since the last call, in their order.
  std::vector<std::string> messages();

 private:
  void changed(bool) override {}

  std::vector<std::string> messages_;
};

}  // namespace grainlaw::python
