#include "dem/runs/run_list.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <memory>

#include "dem/runs/job_list.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::dem {
namespace {

double expected_work(const PlannedRun& run) {
  return run.is_preparation ? expected_work(run.test->preparation) : expected_work(*run.test);
}

/// Whether all fields are equal.
template <HasFields T>
bool same(const T& a, const T& b) {
  bool equal = true;
  for_each_field<T>([&](const auto& field) {
    const auto &of_a = std::invoke(field.access, a), &of_b = std::invoke(field.access, b);
    if constexpr (HasFields<std::remove_cvref_t<decltype(of_a)>>)
      equal = equal && same(of_a, of_b);
    else
      equal = equal && of_a == of_b;
  });
  return equal;
}

/// With the lock of the run, which is given back at the end. A run that others have taken over is left to them.
void make(const PlannedRun& run, const RunStore& store, const ResumePolicy& policy, std::unique_ptr<ProcessLock> lock,
          int threads, const RunControl& control) {
  std::stop_source stop;
  const auto forward = [&] { stop.request_stop(); };
  const std::stop_callback on_wish(control.stop, forward), on_loss(lock->lost(), forward);
  const RunControl ours{control.report, stop.get_token()};
  try {
    without_empty_folders({store.folder(run.key)}, [&] {
      TestSetup test = *run.test;
      test.preparation.engine.threads = threads;
      if (run.is_preparation)
        ensure_preparation(store, test.preparation, policy, ours);
      else
        ensure_test(store, test, policy, ours);
    });
  } catch (const Error&) {
    if (!lock->lost().stop_requested() || control.stop.stop_requested()) throw;
    throw TakenOver();
  }
}

/// A run that is not finished, as a job.
Job job_of(const PlannedRun& run, const RunStore& store, const Execution& execution, std::atomic<std::size_t>& others) {
  const auto lock = std::make_shared<std::unique_ptr<ProcessLock>>();
  const auto told = std::make_shared<bool>(false);
  Job job{run.name, expected_work(run), run.after, {}};
  job.claim = [&run, &store, &others, &watch = execution.watch, lock, told] {
    *lock = store.try_lock(run.key);
    if (!*lock) {
      const auto maker = maker_of(store.root(), run.key);
      if (maker && !std::exchange(*told, true)) watch.log(fmt::format("{}: is made by {}", run.name, *maker));
      return Claim::elsewhere;
    }
    if (!store.find(run.key)) return Claim::mine;
    lock->reset();
    ++others;
    return Claim::finished;
  };
  job.run = [&run, &store, policy = policy_of(execution, run.name), lock](int threads, const RunControl& control) {
    make(run, store, policy, std::move(*lock), threads, control);
  };
  return job;
}

/// A run that others have to finish.
Job awaited(const PlannedRun& run, const RunStore& store, std::atomic<std::size_t>& others) {
  Job job{run.name, expected_work(run), {}, {}};
  job.claim = [&run, &store, &others] {
    if (!is_finished(store.root(), run.key)) return Claim::elsewhere;
    if (!store.find(run.key))
      throw Error(fmt::format("{}: is damaged; the same command without --wait makes it again",
                              store.folder(run.key).string()));
    ++others;
    return Claim::finished;
  };
  return job;
}

/// Says which runs others make and which nobody.
void name_missing(const std::vector<PlannedRun>& runs, const RunStore& store, Watch& watch) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> made, not_begun;
  for (const PlannedRun& run : runs) {
    if (is_finished(store.root(), run.key)) continue;
    const auto maker = maker_of(store.root(), run.key);
    (maker ? made : not_begun).push_back(maker ? fmt::format("{} ({})", run.name, *maker) : run.name);
  }
  const auto say = [&](const char* what, std::vector<std::string> names) {
    if (names.empty()) return;
    const std::size_t all = names.size();
    names.resize(std::min(all, kNamed));
    watch.log(fmt::format("{} of {} runs {}: {}{}", all, runs.size(), what, fmt::join(names, ", "),
                          all > kNamed ? ", ..." : ""));
  };
  say("are being made", made);
  say("are made by nobody now", not_begun);
}

}  // namespace

std::string run_of(const PlannedTest& test) {
  return test.branch_of_preparation ? preparation_key(test.preparation) : test_key(test);
}

std::vector<PlannedRun> runs_of(const std::vector<PlannedTest>& tests) {
  std::vector<PlannedRun> runs;
  std::map<std::string, std::size_t> index;
  std::vector<std::string> preparations(tests.size());
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const PlannedTest& test = tests[i];
    if (test.given) continue;
    const bool as_before = i > 0 && !tests[i - 1].given && same(tests[i - 1].preparation, test.preparation);
    preparations[i] = as_before ? preparations[i - 1] : preparation_key(test.preparation);  // digests take time
    if (!index.try_emplace(preparations[i], runs.size()).second) continue;
    runs.push_back({preparations[i], fmt::format("preparation-s{}", test.preparation.packing.seed), &test, true, {}});
  }
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const PlannedTest& test = tests[i];
    if (test.branch_of_preparation) continue;
    if (test.preparation.choice.is_lammps() && (test.probes || test.frames > 0))
      throw InvalidInput(fmt::format("test '{}': {}: belongs to the engine 'grainlaw'; remove it from what LAMMPS runs",
                                     test.name, test.probes ? "probes" : "frames"));
    const std::string key = test_key(test);
    if (!index.try_emplace(key, runs.size()).second) continue;
    runs.push_back({key, test.name, &test, false, {}});
    if (!test.given) runs.back().after = index.at(preparations[i]);
  }
  return runs;
}

std::vector<PlannedRun> with_preparations(const std::vector<PlannedRun>& runs, const std::vector<std::size_t>& places) {
  std::vector<PlannedRun> chosen;
  std::map<std::size_t, std::size_t> index;  // from place in `runs` to place here
  const auto add = [&](std::size_t place) {
    if (index.try_emplace(place, chosen.size()).second) chosen.push_back(runs[place]);
  };
  for (const std::size_t place : places) {
    if (runs[place].is_preparation) add(place);
    if (runs[place].after) add(*runs[place].after);
  }
  for (const std::size_t place : places) add(place);
  for (PlannedRun& run : chosen) {
    if (run.after) run.after = index.at(*run.after);
  }
  return chosen;
}

void make_runs(const std::vector<PlannedRun>& runs, const RunStore& store, const Execution& execution,
               RunCounts& counts, MissingRuns missing) {
  std::vector<Job> jobs;
  std::atomic<std::size_t> others = 0;
  for (const PlannedRun& run : runs) {
    ++counts.runs;
    if (store.find(run.key)) {
      ++counts.found;
      jobs.push_back({run.name, 0, {}, {}, [] { return Claim::finished; }});
    } else {
      jobs.push_back(missing == MissingRuns::awaited ? awaited(run, store, others)
                                                     : job_of(run, store, execution, others));
    }
  }
  const auto name_awaited = [&] {
    if (missing == MissingRuns::awaited) name_missing(runs, store, execution.watch);
  };
  name_awaited();
  try {
    run_jobs(jobs, execution.threads, execution.watch, execution.stop);
  } catch (const Interrupted&) {
    name_awaited();
    throw;
  }
  counts.others += others;
}

}  // namespace grainlaw::dem
