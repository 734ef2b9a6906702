#include "dem/runs/simulation.hpp"

#include <fmt/format.h>

#include <set>

#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/column.hpp"
#include "model/files/json_document.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

/// What unloading.csv was observed on.
Path unloading_branch(const PreparationOptions& options) {
  TestRequest iso;
  iso.mode = "ISO";
  Spec spec;
  spec.preparation = options;
  return path_of(iso, 0, spec);
}

/// Last row of a series: what most want to see first.
OrderedJson end_values(const Observation& row) {
  OrderedJson values = OrderedJson::object();
  for (const auto& column : columns_of<Observation>()) {
    for (const char* wanted : {"time", "eps_vol", "eps_dev", "nu", "P_star", "s_dev", "F_v", "F_dev", "C_star",
                               "rattler_fraction", "energy_residual"}) {
      if (column.name == wanted) values[column.title()] = number_or_null(column.get(row));
    }
  }
  return values;
}

/// Why values of that row are null, by name.
OrderedJson reasons_of(const OrderedJson& values) {
  OrderedJson reasons = OrderedJson::object();
  for (const auto& value : values.items()) {
    if (!value.value().is_null()) continue;
    reasons[value.key()] = value.key() == "C_star"            ? "no sphere has four contacts"
                           : value.key() == "s_dev"           ? "the pressure is not positive"
                           : value.key() == "energy_residual" ? "LAMMPS tells no energies"
                                                              : "it is not defined without spheres in contact";
  }
  return reasons;
}

/// Cell of end.csv, as TEST's key `cell` takes it.
OrderedJson cell_to_json(const Eigen::Matrix3d& H) {
  OrderedJson rows = OrderedJson::array();
  for (int i = 0; i < 3; ++i) rows.push_back({H(i, 0), H(i, 1), H(i, 2)});
  return rows;
}

/// Copies the files of a finished run into the user's folder.
std::vector<std::string> publish(const RunStore& store, const std::string& key, const Json& record,
                                 const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& file : record.at("files").items()) {
    const fs::path from = store.folder(key) / file.key(), to = folder / file.key();
    if (file.key().starts_with("frame-"))
      link_or_copy(from, to);  // there may be hundreds, and nobody edits them
    else
      copy_whole(from, to);
    names.push_back(file.key());
  }
  sync_files_below(folder);
  return names;
}

/// Series and states that an earlier test has left in the folder, by its simulation.json.
std::set<std::string> files_of_before(const fs::path& folder) {
  std::set<std::string> names;
  try {
    if (fs::exists(folder / "simulation.json"))
      names = read_json(folder / "simulation.json", JsonSource::own).at("files").get<std::set<std::string>>();
  } catch (const std::exception&) {
    names.clear();  // nobody's, or damaged: it is replaced, and what it listed is left alone
  }
  std::erase_if(names, [](const std::string& name) {
    return !is_safe_name(name) || !(name.ends_with(".csv") || name.ends_with(".state") || name.ends_with(".restart"));
  });
  return names;
}

/// Refuses a folder in which the test would write over what it starts from, or remove it.
void require_start_survives(const TestFile& test, const fs::path& output) {
  const std::string name = test.given_file.filename().string();
  const bool written = name == "end.state" || name == "end.csv" || name.starts_with("frame-");
  if (!written && !files_of_before(output).contains(name)) return;
  const fs::path folder = test.given_file.has_parent_path() ? test.given_file.parent_path() : ".";
  std::error_code absent;
  if (!fs::equivalent(folder, output, absent)) return;
  throw InvalidInput(fmt::format("{}: the test starts from it and would overwrite it; give another folder with -o",
                                 test.given_file.string()));
}

SimulationResult simulate_into(const TestFile& test, const fs::path& output, const Execution& execution) {
  make_output_folder(output);
  const RunStore store(output, "runs");
  const bool prepared = test.start == Start::preparation;
  const std::vector<PlannedTest> tests{{test, "element test", Role::validation, prepared}};
  RunCounts counts;
  make_runs(runs_of(tests), store, execution, counts);
  const auto lock = lock_results(output, execution);
  const std::string key = run_of(tests.front());
  std::set<std::string> stale = files_of_before(output);
  const Json record = store.finished(key);
  std::vector<std::string> files = publish(store, key, record, output);
  const Path path = prepared ? unloading_branch(test.preparation) : test.path;
  SimulationResult simulation;
  simulation.rows =
      read_series(output / (prepared ? "unloading.csv" : "series.csv"), path, packing_from_record(record));
  simulation.warnings = record.at("warnings").get<std::vector<std::string>>();
  OrderedJson& summary = simulation.summary;
  summary = {{"format", "grainlaw simulation"}, {"format_version", 1}, {"run", key}, {"rows", simulation.rows.size()}};
  summary["packing"] = OrderedJson(record.at("packing"));
  if (prepared) {
    summary["states"] = OrderedJson(record.at("states"));
  } else {
    summary["path"] = path_to_json(test.path);
    const Packing end = read_state(output / "end.state").packing;
    write_spheres(output / "end.csv", end);
    files.emplace_back("end.csv");
    summary["cell"] = cell_to_json(end.H);
  }
  summary["end"] = end_values(simulation.rows.back());
  summary["undefined"] = reasons_of(summary["end"]);
  summary["cost"] = OrderedJson(record.at("cost"));
  summary["warnings"] = simulation.warnings;
  summary["files"] = files;
  summary["provenance"] = provenance(execution);
  for (const std::string& name : files) stale.erase(name);
  for (const std::string& name : stale) fs::remove(output / name);  // beside these they would be taken for this test's
  write_json(output / "simulation.json", summary);
  for (const std::string& warning : simulation.warnings) execution.watch.log("warning: " + warning);
  return simulation;
}

}  // namespace

SimulationResult simulate(const TestFile& test, const fs::path& output, const Execution& execution) {
  require_start_survives(test, output);
  require_engines({{test, "", Role::validation, test.start == Start::preparation}}, output, execution);
  return without_empty_folders({output}, [&] { return simulate_into(test, output, execution); });
}

}  // namespace grainlaw::dem
