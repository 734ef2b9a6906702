#include "python/progress_record.hpp"

#include <utility>

#include "model/files/one_line.hpp"

namespace grainlaw::python {

void ProgressRecord::end() {
  const std::lock_guard lock(mutex_);
  for (Job& job : jobs_) job.running = false;
}

void ProgressRecord::log(const std::string& text) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(one_line(text));
}

std::pair<double, std::string> ProgressRecord::status() {
  const std::lock_guard lock(mutex_);
  double expected = 0, covered = 0;
  std::string text;
  for (const Job& job : jobs_) {
    expected += job.expected;
    covered += this->covered(job);
    if (job.running) text += (text.empty() ? "" : ", ") + (job.stage.empty() ? job.name : job.stage);
  }
  return {expected > 0 ? covered / expected : 0, text};
}

std::vector<std::string> ProgressRecord::messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

}  // namespace grainlaw::python
