#include "dem/runs/task_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/expected_cost.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLeastDigits = 8;  // of a key

/// Whether `word` means the run.
bool means(const std::string& word, const ListedRun& run) {
  return word == std::to_string(run.task) || word == run.name ||
         (word.size() >= kLeastDigits && run.key.starts_with(word));
}

}  // namespace

std::vector<ListedRun> listed(const std::vector<PlannedRun>& runs) {
  std::vector<ListedRun> list;
  for (const PlannedRun& run : runs) {
    list.push_back({0, run.name, run.key, run.after ? runs[*run.after].key : "", expected_particle_steps(run)});
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const ListedRun& a, const ListedRun& b) { return a.particle_steps > b.particle_steps; });
  return list;
}

void deal(std::vector<ListedRun>& runs, int tasks) {
  std::stable_partition(runs.begin(), runs.end(), [](const ListedRun& run) { return run.preparation.empty(); });
  std::vector<double> load(std::min(runs.size(), static_cast<std::size_t>(tasks)));
  double share = 0;
  for (const ListedRun& run : runs) share += run.particle_steps / static_cast<double>(load.size());
  std::map<std::string, std::size_t> task_of;  // of preparations
  for (ListedRun& run : runs) {
    auto task = static_cast<std::size_t>(std::min_element(load.begin(), load.end()) - load.begin());
    if (const auto own = task_of.find(run.preparation);
        own != task_of.end() && load[own->second] + run.particle_steps <= share)
      task = own->second;
    if (run.preparation.empty()) task_of[run.key] = task;
    load[task] += run.particle_steps;
    run.task = static_cast<int>(task) + 1;
  }
  std::stable_sort(runs.begin(), runs.end(), [](const ListedRun& a, const ListedRun& b) { return a.task < b.task; });
}

TaskList write_tasks(const Spec& spec, int tasks, const fs::path& output, const Execution& execution) {
  const std::vector<PlannedTest> tests = plan(spec);
  TaskList list{spec, listed(runs_of(tests))};
  std::erase_if(list.runs, [&](const ListedRun& run) { return is_finished(output / "runs", run.key); });
  deal(list.runs, tasks);
  make_output_folder(output);
  const fs::path folder = make_subfolder(output, kTasksFolder);
  write_json(folder / "spec.json", spec_to_json(list.spec));
  OrderedJson document{{"format", "grainlaw tasks"}, {"format_version", 1}};
  document["runs"] = fields_to_json(list.runs);
  document["provenance"] = provenance(execution);
  write_json(folder / "tasks.json", document);
  return list;
}

TaskList read_tasks(const fs::path& output) {
  const fs::path folder = output / kTasksFolder, file = folder / "tasks.json";
  if (!fs::exists(file))
    throw InvalidInput(
        fmt::format("{}: not found; grainlaw runs SPEC -o {} --array N writes it", file.string(), output.string()));
  TaskList list{read_spec(folder / "spec.json"), {}};
  const Json document = read_json(file, JsonSource::own);
  try {
    read_fields(document.at("runs"), list.runs);
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), one_line(error.what(), 200)));
  }
  return list;
}

RunCounts make_tasks(const TaskList& list, const std::vector<std::string>& which, const fs::path& output,
                     const Execution& execution) {
  const std::string file = (output / kTasksFolder / "tasks.json").string();
  const std::vector<PlannedTest> tests = plan(list.spec);
  const std::vector<PlannedRun> runs = runs_of(tests);
  std::map<std::string, std::size_t> place_of;
  for (std::size_t i = 0; i < runs.size(); ++i) place_of[runs[i].key] = i;
  std::vector<std::size_t> places;
  for (const std::string& word : which) {
    bool found = false;
    for (const ListedRun& run : list.runs) {
      if (!means(word, run)) continue;
      found = true;
      const auto place = place_of.find(run.key);
      if (place == place_of.end())
        throw InvalidInput(
            fmt::format("{}: {} is no run of this version or of spec.json beside it; write it anew", file, run.name));
      places.push_back(place->second);
    }
    if (!found) throw InvalidInput(fmt::format("{}: has no task, run or key '{}'", file, one_line(word, 70)));
  }
  require_engines(tests, output, execution);
  RunCounts counts;
  const RunStore store(output, "runs");
  make_runs(with_preparations(runs, places), store, execution, counts);
  return counts;
}

}  // namespace grainlaw::dem
