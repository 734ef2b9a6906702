#include "chain/rehearsals.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/reading.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

/// "UNI-0.695" of "UNI-0.695-s11".
std::string name_of_path(const TestRecord& run) {
  const std::string seed = fmt::format("-s{}", run.packing.seed);
  return run.name.ends_with(seed) ? run.name.substr(0, run.name.size() - seed.size()) : run.name;
}

std::vector<predict::RehearsalRuns> by_path(const std::vector<TestRecord>& runs, const Dataset* dataset) {
  std::vector<predict::RehearsalRuns> paths;
  for (const TestRecord& run : runs) {
    const Json path = Json(path_to_json(run.path));
    auto found = std::ranges::find_if(paths, [&](const predict::RehearsalRuns& known) {
      return Json(path_to_json(known.runs.front().path)) == path;
    });
    if (found == paths.end()) found = paths.insert(paths.end(), {name_of_path(run), {}, false});
    found->runs.push_back(run);
    if (dataset != nullptr && is_fitted(run.packing, *dataset)) found->fitted_packings = true;
  }
  return paths;
}

std::vector<fs::path> rehearsal_folders(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::path& entry : entries_of(folder / kRehearsalsFolder)) {
    if (fs::exists(entry / "dataset.json")) folders.push_back(entry);
  }
  return folders;
}

}  // namespace

bool is_fitted(const PackingInfo& packing, const TestRecord& test) {
  const PackingInfo& other = test.packing;
  return test.role == Role::calibration && other.seed == packing.seed && other.particles == packing.particles &&
         other.mean_radius == packing.mean_radius;
}

bool is_fitted(const PackingInfo& packing, const Dataset& dataset) {
  return std::ranges::any_of(dataset.tests, [&](const DatasetTest& test) { return is_fitted(packing, test.record); });
}

std::vector<predict::RehearsalRuns> read_rehearsals(const fs::path& given, const std::string& name,
                                                    const Dataset* dataset) {
  const fs::path folder = dataset_folder(given);
  const Dataset runs = read_dataset(folder);
  std::vector<TestRecord> records;
  for (const DatasetTest& test : runs.tests) {
    if (test.record.role == Role::calibration) {
      throw InvalidInput(fmt::format("{}: test {} is of role calibration; a rehearsal is a path that no fit has seen",
                                     folder.string(), test.record.name));
    }
    records.push_back(test.record);
  }
  if (dataset != nullptr) require_judges(runs, *dataset, folder.string());
  std::vector<predict::RehearsalRuns> paths = by_path(records, dataset);
  if (paths.size() == 1) paths.front().name = name;
  return paths;
}

std::vector<predict::RehearsalRuns> rehearsals_of(const Dataset& dataset, const fs::path& folder) {
  std::vector<predict::RehearsalRuns> all = by_path(tests_of(dataset, Role::rehearsal), &dataset);
  for (const fs::path& each : rehearsal_folders(folder)) {
    for (predict::RehearsalRuns& path : read_rehearsals(each, each.filename().string(), &dataset))
      all.push_back(std::move(path));
  }
  return all;
}

void require_rehearsals_of(const PackingInfo& packing, const fs::path& folder) {
  for (const fs::path& each : rehearsal_folders(folder)) {
    for (const DatasetTest& test : read_dataset(each).tests) {
      const std::string differs = other_material(test.record.packing, packing);
      if (differs.empty()) continue;
      throw InvalidInput(
          fmt::format("{}: test {}: {} in SPEC; a law is of one material, give another -o or remove this folder",
                      each.string(), test.record.name, differs));
    }
  }
}

std::vector<std::string> adopt_rehearsals(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (fs::equivalent(from, to, error)) return {};
  std::vector<std::string> aside;
  for (const fs::path& each : rehearsal_folders(to)) {
    if (fs::exists(from / kRehearsalsFolder / each.filename() / "dataset.json")) continue;
    fs::path place = make_subfolder(to, kRehearsalsOfBefore) / each.filename();
    while (fs::exists(place)) place += "-";
    fs::rename(each, place);
    aside.push_back(place.string());
  }
  for (const fs::path& each : rehearsal_folders(from)) {
    adopt(read_dataset(each), each, make_subfolder(make_subfolder(to, kRehearsalsFolder), each.filename().string()));
  }
  return aside;
}

void rehearse(CalibratedLaw& law, const std::vector<predict::RehearsalRuns>& paths, const Execution& execution) {
  law.rehearsals.clear();
  const std::vector<Rung> rungs = calibrated_rungs(law);
  for (const predict::RehearsalRuns& path : paths) {
    std::vector<std::string> failures;
    try {
      law.rehearsals.push_back(predict::rehearsal_of(law, rungs, path, {{}, execution.stop}, failures));
    } catch (const InvalidInput& error) {
      failures.push_back(fmt::format("rehearsal {} is left out: {}", path.name, error.what()));
    }
    for (const std::string& failure : failures) execution.watch.log("warning: " + failure);
  }
}

void check_rehearsal(const CalibratedLaw& law, const Path& path, const std::string& name) {
  if (!is_safe_name(name))
    throw InvalidInput(fmt::format("rehearsal '{}': letters, digits, '.', '-' and '_' make a name", name));
  for (const Rehearsal& known : law.rehearsals) {
    const bool same = same_but_axes(resolve(known.path), resolve(path));
    if (same == (known.name == name)) continue;
    throw InvalidInput(
        same ? fmt::format("rehearsal '{}': its path is rehearsed as '{}'; give -o that name to take its place", name,
                           known.name)
             : fmt::format("rehearsal '{}': is another path of the law already; give -o another name", name));
  }
}

void add_rehearsal(const fs::path& parameters, const fs::path& given, const std::string& name,
                   const Execution& execution) {
  ParametersFile file = read_parameters(parameters);
  const fs::path beside = parameters.has_parent_path() ? parameters.parent_path() : fs::path(".");
  const std::optional<Dataset> fitted = fitted_dataset(parameters, file.law.dataset_digest);
  const auto paths = read_rehearsals(given, name, fitted ? &*fitted : nullptr);
  if (paths.size() != 1)
    throw InvalidInput(fmt::format("{}: holds runs of {} paths; a rehearsal is one", given.string(), paths.size()));
  check_rehearsal(file.law, paths.front().runs.front().path, name);
  std::vector<std::string> failures;
  Rehearsal added =
      predict::rehearsal_of(file.law, calibrated_rungs(file.law), paths.front(), {{}, execution.stop}, failures);
  if (added.rungs.empty() && !failures.empty()) throw NotConverged(failures.front());
  for (const std::string& failure : failures) execution.watch.log("warning: " + failure);
  std::erase_if(file.law.rehearsals, [&](const Rehearsal& known) { return known.name == name; });
  file.law.rehearsals.push_back(std::move(added));
  if (fitted) {
    const fs::path from = dataset_folder(given);
    adopt(read_dataset(from), from, make_subfolder(make_subfolder(beside / "dataset", kRehearsalsFolder), name));
  }
  write_parameters(parameters, file);
}

}  // namespace grainlaw::chain
