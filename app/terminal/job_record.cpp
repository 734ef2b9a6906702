#include "app/terminal/job_record.hpp"

#include <algorithm>
#include <utility>

namespace grainlaw::app {

void JobRecord::begin(const std::vector<double>& work, std::string unit) {
  const std::lock_guard lock(mutex_);
  jobs_.assign(work.size(), {});
  unit_ = std::move(unit);
  for (std::size_t i = 0; i < work.size(); ++i) {
    jobs_[i].expected = work[i];
    jobs_[i].done = work[i] == 0;
  }
}

RunControl JobRecord::control(std::size_t index, std::string name, std::stop_token stop) {
  const std::lock_guard lock(mutex_);
  jobs_[index].name = std::move(name);
  jobs_[index].running = true;
  const auto report = [this, index](const Progress& progress) {
    const std::lock_guard guard(mutex_);
    Job& job = jobs_[index];
    job.stage = progress.stage;
    job.fraction = progress.fraction;
    if (progress.unit == unit_) {  // only what was planned for counts: passes of a minimiser are no particle-steps
      if (!job.first) job.first = progress.work;
      job.work = progress.work;
    }
    changed(false);
  };
  return {report, std::move(stop)};
}

void JobRecord::finished(std::size_t index) {
  const std::lock_guard lock(mutex_);
  jobs_[index].running = false;
  jobs_[index].done = true;
  changed(true);
}

double JobRecord::covered(const Job& job) const {
  if (job.done) return job.expected;
  return unit_.empty() ? job.expected * job.fraction : std::min(job.work, 0.99 * job.expected);
}

}  // namespace grainlaw::app
