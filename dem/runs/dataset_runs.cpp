#include "dem/runs/dataset_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "dem/lammps/program.hpp"
#include "dem/runs/feasibility.hpp"
#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<PlannedTest> plan(const Spec& spec) {
  std::vector<PlannedTest> tests;
  for (const std::uint64_t seed : spec.seeds) {
    PreparationOptions preparation = spec.preparation;
    preparation.packing.seed = seed;
    const auto add = [&](const TestRequest& request, double nu) {
      PlannedTest& test = tests.emplace_back();
      test.preparation = preparation;
      test.path = path_of(request, nu, spec);
      test.rows = preparation.rows;
      test.probes = request.probes;
      test.name = record_name(request, nu, seed);
      test.role = request.role;
      test.branch_of_preparation = request.mode == "ISO";
    };
    for (const TestRequest& request : spec.tests) {
      if (request.mode == "ISO") add(request, 0);
      for (const double nu : request.densities) add(request, nu);
    }
  }
  return tests;
}

std::vector<std::uint64_t> new_seeds(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& wished,
                                     const std::vector<std::uint64_t>& fitted, const std::string& name) {
  std::vector<std::uint64_t> seeds = wished.empty() ? path.seeds : wished;
  std::set<std::uint64_t> used(spec.seeds.begin(), spec.seeds.end());
  used.insert(fitted.begin(), fitted.end());
  if (seeds.empty()) {
    const std::uint64_t largest = *used.rbegin();
    for (std::size_t i = 1; i <= spec.seeds.size(); ++i) seeds.push_back(largest + i);
  }
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (used.contains(seeds[i])) {
      throw InvalidInput(
          fmt::format("{}: seeds: {} was used for the calibration; a prediction is tested on packings it has not seen, "
                      "give another",
                      name, seeds[i]));
    }
    if (std::find(seeds.begin(), seeds.begin() + static_cast<std::ptrdiff_t>(i), seeds[i]) !=
        seeds.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InvalidInput(fmt::format("{}: seeds: {} is given twice", name, seeds[i]));
    }
  }
  return seeds;
}

std::vector<PlannedTest> plan(const Spec& spec, const PathFile& path, const std::vector<std::uint64_t>& seeds,
                              const std::string& name) {
  PreparationOptions preparation = spec.preparation;
  // only what predictions start from: paths that name the spec's `keep` share their packings
  preparation.keep_loading.clear();
  preparation.keep_unloading = spec.keep;
  auto& kept = path.path.branch == Branch::loading ? preparation.keep_loading : preparation.keep_unloading;
  if (std::find(kept.begin(), kept.end(), path.path.nu) == kept.end()) kept.push_back(path.path.nu);
  std::sort(kept.begin(), kept.end());
  complete_preparation(preparation, name);
  check_path(path.path, preparation, name);

  TestRequest request;
  request.branch = path.path.branch;
  request.segments = path.path.segments;
  request.name = default_name(request);
  std::vector<PlannedTest> tests;
  for (const std::uint64_t seed : seeds) {
    preparation.packing.seed = seed;
    tests.push_back({{preparation, path.path, path.rows.value_or(preparation.rows)},
                     record_name(request, path.path.nu, seed),
                     Role::validation});
  }
  return tests;
}

void require_engines(const std::vector<PlannedTest>& tests, const fs::path& parent, const Execution& execution) {
  bool asked = false;
  for (const PlannedTest& test : tests) {
    if (!test.preparation.choice.is_lammps()) continue;
    asked = asked || !is_finished(parent / "runs", run_of(test));
  }
  if (asked) find_lammps(execution.lammps, execution.launcher);
}

std::unique_ptr<ProcessLock> lock_results(const fs::path& folder, const Execution& execution) {
  make_output_folder(folder);  // another may have left nothing and taken it along
  remove_dead_locks(folder);
  return ProcessLock::wait(folder / ".results.lock", execution.stop, [&](const std::string& owner) {
    execution.watch.log(fmt::format("waits for {}, which writes results to {}", owner, folder.string()));
  });
}

Dataset run_planned(const std::vector<PlannedTest>& tests, const Json& spec, const fs::path& folder,
                    const RunStore& store, const Execution& execution, RunCounts& counts) {
  make_runs(runs_of(tests), store, execution, counts);
  return collect_runs(tests, spec, folder, store, execution);
}

Dataset collect_runs(const std::vector<PlannedTest>& tests, const Json& spec, const fs::path& folder,
                     const RunStore& store, const Execution& execution) {
  const auto lock = lock_results(folder, execution);
  const std::set<std::string> listed = series_listed(folder);
  Dataset dataset;
  dataset.spec = spec;
  for (const PlannedTest& planned : tests) {
    DatasetTest test;
    test.run = run_of(planned);
    const Json record = store.finished(test.run);
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
    }
    const std::uint64_t seed = planned.preparation.packing.seed;
    if (std::find(dataset.seeds.begin(), dataset.seeds.end(), seed) == dataset.seeds.end())
      dataset.seeds.push_back(seed);
    dataset.tests.push_back(std::move(test));
  }
  dataset.provenance = Json(provenance(execution));
  write_dataset_index(folder, dataset);
  remove_stale_series(folder, listed, dataset);
  return dataset;
}

}  // namespace grainlaw::dem
