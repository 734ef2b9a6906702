#include "python/progress_record.hpp"

#include <algorithm>

#include "model/files/one_line.hpp"

namespace grainlaw::python {

void ProgressRecord::begin(const std::vector<double>& work, std::string unit) {
  const std::lock_guard lock(mutex_);
  jobs_.assign(work.size(), {});
  unit_ = std::move(unit);
  for (std::size_t i = 0; i < work.size(); ++i) {
    jobs_[i].expected = work[i];
    jobs_[i].done = work[i] == 0;
  }
}

RunControl ProgressRecord::control(std::size_t index, std::string name, std::stop_token stop) {
  const std::lock_guard lock(mutex_);
  jobs_[index].name = std::move(name);
  jobs_[index].running = true;
  return {[this, index](const Progress& progress) {
            const std::lock_guard guard(mutex_);
            Job& job = jobs_[index];
            job.stage = progress.stage;
            job.fraction = progress.fraction;
            if (progress.unit == unit_) job.work = progress.work;  // passes of a minimiser are no particle-steps
          },
          std::move(stop)};
}

void ProgressRecord::finished(std::size_t job) {
  const std::lock_guard lock(mutex_);
  jobs_[job].running = false;
  jobs_[job].done = true;
}

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
    covered += job.done        ? job.expected
               : unit_.empty() ? job.expected * job.fraction
                               : std::min(job.work, 0.99 * job.expected);
    if (job.running) text += (text.empty() ? "" : ", ") + (job.stage.empty() ? job.name : job.stage);
  }
  return {expected > 0 ? covered / expected : 0, text};
}

std::vector<std::string> ProgressRecord::messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

}  // namespace grainlaw::python
