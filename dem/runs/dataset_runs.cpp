#include "dem/runs/dataset_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "model/files/digest.hpp"
#include "dem/runs/preparation_json.hpp"
#include "model/files/series_csv.hpp"
#include "model/files/output_folder.hpp"
#include "dem/runs/job_list.hpp"
#include "dem/runs/runs.hpp"
#include "model/files/durable_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

std::string preparation_key(const PlannedTest& test) { return run_key(preparation_request(test.preparation)); }

TestStart start_of(const PlannedTest& test) { return {test.preparation, test.rows, {}, "", false, test.probes}; }

std::string test_key(const PlannedTest& test) {
  return test.branch_of_preparation ? preparation_key(test) : run_key(test_request(start_of(test), test.path));
}

double particles(const PlannedTest& test) { return static_cast<double>(test.preparation.packing.particles); }

/// Preparations first, then the tests in order; each key once.
std::vector<Job> jobs_for(const std::vector<PlannedTest>& tests, const RunStore& store, const Execution& execution,
                          RunCounts& counts) {
  std::vector<Job> jobs;
  std::map<std::string, std::size_t> index;
  const auto add = [&](const std::string& key, Job job) {
    ++counts.runs;
    if (store.find(key)) {
      ++counts.found;
      job.work = 0;
    }
    index[key] = jobs.size();
    jobs.push_back(std::move(job));
  };
  for (const PlannedTest& test : tests) {
    const std::string key = preparation_key(test);
    if (index.contains(key)) continue;
    const auto& options = test.preparation;
    const std::string name = fmt::format("seed {}", options.packing.seed);
    add(key, {name, particles(test) * expected_steps(options), std::nullopt,
              [&store, &options, policy = policy_of(execution, name)](int threads, const RunControl& control) {
                PreparationOptions with_threads = options;
                with_threads.engine.threads = threads;
                ensure_preparation(store, with_threads, policy, control);
              }});
  }
  for (const PlannedTest& test : tests) {
    const std::string key = test_key(test);
    if (index.contains(key)) continue;
    add(key, {test.name, particles(test) * expected_steps(test.preparation, resolve(test.path)),
              index.at(preparation_key(test)),
              [&store, &test, policy = policy_of(execution, test.name)](int threads, const RunControl& control) {
                TestStart start = start_of(test);
                start.preparation.engine.threads = threads;
                ensure_test(store, start, test.path, policy, control);
              }});
  }
  return jobs;
}

std::set<std::string> series_listed(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder / "dataset.json")) return names;
  try {
    const Json index = read_json(folder / "dataset.json", JsonSource::own);
    for (const Json& test : index.at("tests")) names.insert(test.at("name"));
  } catch (const std::exception&) {
    names.clear();  // damaged: it is replaced, and what it listed is left alone
  }
  return names;
}

}  // namespace

std::vector<PlannedTest> plan(const Spec& spec) {
  std::vector<PlannedTest> tests;
  for (const std::uint64_t seed : spec.seeds) {
    PreparationOptions preparation = spec.preparation;
    preparation.packing.seed = seed;
    for (const TestRequest& request : spec.tests) {
      if (request.mode == "ISO") {
        tests.push_back({record_name(request, 0, seed), request.role, path_of(request, 0, spec), preparation,
                         preparation.rows, true});
      }
      for (const double nu : request.densities) {
        tests.push_back({record_name(request, nu, seed), request.role, path_of(request, nu, spec), preparation,
                         preparation.rows, false, request.probes});
      }
    }
  }
  return tests;
}

Dataset run_planned(const std::vector<PlannedTest>& tests, const Json& spec, const fs::path& folder,
                    const RunStore& store, const Execution& execution, RunCounts& counts) {
  run_jobs(jobs_for(tests, store, execution, counts), execution.threads, execution.watch, execution.stop);

  std::set<std::string> stale = series_listed(folder), stale_probes = stale;
  Dataset dataset;
  dataset.spec = spec;
  for (const PlannedTest& planned : tests) {
    DatasetTest test;
    test.run = test_key(planned);
    const Json record = store.find(test.run).value();
    test.record = {planned.name, planned.role, planned.path, packing_from_record(record), {}};
    test.cost = cost_from_record(record);
    for (const Json& warning : record.at("warnings")) test.warnings.push_back(warning);
    const std::string series = planned.branch_of_preparation ? to_string(planned.path.branch) : "series";
    const fs::path file = folder / (planned.name + ".csv");
    copy_durably(store.folder(test.run) / (series + ".csv"), file);
    test.record.rows = read_series(file, planned.path, test.record.packing);
    if (planned.probes) {
      const fs::path probes = make_subfolder(folder, kProbesFolder) / (planned.name + ".csv");
      copy_durably(store.folder(test.run) / "probes.csv", probes);
      test.probes_sha256 = sha256_of_file(probes);
      stale_probes.erase(planned.name);
    }
    stale.erase(planned.name);
    const std::uint64_t seed = planned.preparation.packing.seed;
    if (std::find(dataset.seeds.begin(), dataset.seeds.end(), seed) == dataset.seeds.end())
      dataset.seeds.push_back(seed);
    dataset.tests.push_back(std::move(test));
  }
  dataset.provenance = Json(provenance(execution));
  write_dataset_index(folder, dataset);
  for (const std::string& name : stale) {
    if (is_safe_name(name)) fs::remove(folder / (name + ".csv"));
  }
  for (const std::string& name : stale_probes) {
    if (is_safe_name(name)) fs::remove(folder / kProbesFolder / (name + ".csv"));
  }
  return dataset;
}

}  // namespace grainlaw::dem
