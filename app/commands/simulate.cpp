#include "app/commands/simulate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/files/digest.hpp"
#include "model/files/path_json.hpp"
#include "dem/runs/preparation_json.hpp"
#include "model/files/column.hpp"
#include "model/files/series_csv.hpp"
#include "dem/runs/spec_file.hpp"
#include "dem/runs/test_file.hpp"
#include "model/files/output_folder.hpp"
#include "dem/runs/job_list.hpp"
#include "dem/runs/runs.hpp"
#include "model/files/durable_file.hpp"
#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

dem::TestStart start_of(const dem::TestFile& test) {
  return {test.preparation, test.preparation.rows, test.given, test.given_digest, test.relax, test.probes};
}

/// The jobs of the file: the preparation unless the packing is given, then the test unless there is none.
void run(const dem::TestFile& test, const dem::RunStore& store, Session& session) {
  std::vector<dem::Job> jobs;
  if (!test.given) {
    const bool done = store.find(dem::run_key(dem::preparation_request(test.preparation))).has_value();
    const auto particles = static_cast<double>(test.preparation.packing.particles);
    const std::string name = fmt::format("preparation of seed {}", test.preparation.packing.seed);
    jobs.push_back({name, done ? 0 : particles * dem::expected_steps(test.preparation), std::nullopt,
                    [&, policy = dem::policy_of(session, name)](int threads, const RunControl& control) {
                      dem::PreparationOptions options = test.preparation;
                      options.engine.threads = threads;
                      dem::ensure_preparation(store, options, policy, control);
                    }});
  }
  if (test.start != dem::Start::preparation) {
    const double particles = test.given ? static_cast<double>(test.given->packing.size())
                                        : static_cast<double>(test.preparation.packing.particles);
    const bool done = store.find(dem::run_key(dem::test_request(start_of(test), test.path))).has_value();
    jobs.push_back({"element test",
                    done ? 0 : particles * std::max(1.0, dem::expected_steps(test.preparation, resolve(test.path))),
                    jobs.empty() ? std::nullopt : std::optional<std::size_t>(0),
                    [&, policy = dem::policy_of(session, "element test")](int threads, const RunControl& control) {
                      dem::TestStart start = start_of(test);
                      start.preparation.engine.threads = threads;
                      dem::ensure_test(store, start, test.path, policy, control);
                    }});
  }
  dem::run_jobs(jobs, session.threads, session.watch, session.stop);
}

/// What unloading.csv was observed on.
Path unloading_branch(const dem::PreparationOptions& options) {
  dem::TestRequest iso;
  iso.mode = "ISO";
  dem::Spec spec;
  spec.preparation = options;
  return dem::path_of(iso, 0, spec);
}

std::string value_text(double value) { return std::isnan(value) ? "undefined" : fmt::format("{:.6g}", value); }

/// Last row of a series: what most want to see first.
OrderedJson end_values(const Observation& row) {
  OrderedJson values;
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
    reasons[value.key()] = value.key() == "C_star"  ? "no sphere has four contacts"
                           : value.key() == "s_dev" ? "the pressure is not positive"
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
std::vector<std::string> publish(const dem::RunStore& store, const std::string& key, const Json& record,
                                 const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& file : record.at("files").items()) {
    copy_durably(store.folder(key) / file.key(), folder / file.key());
    names.push_back(file.key());
  }
  return names;
}

}  // namespace

ExitCode simulate(const SimulateOptions& options, Session& session) {
  const dem::TestFile test = dem::read_test(options.test);
  make_output_folder(options.output);
  const dem::RunStore store(options.output, "runs");
  run(test, store, session);

  const bool prepared = test.start == dem::Start::preparation;
  const std::string key =
      dem::run_key(prepared ? dem::preparation_request(test.preparation) : dem::test_request(start_of(test), test.path));
  const Json record = store.find(key).value();
  std::vector<std::string> files = publish(store, key, record, options.output);
  const Path path = prepared ? unloading_branch(test.preparation) : test.path;
  const auto rows =
      read_series(options.output / (prepared ? "unloading.csv" : "series.csv"), path, dem::packing_from_record(record));
  OrderedJson summary{{"format", "grainlaw simulation"}, {"format_version", 1}, {"run", key}, {"rows", rows.size()}};
  summary["packing"] = OrderedJson(record.at("packing"));
  if (prepared) {
    summary["states"] = OrderedJson(record.at("states"));
  } else {
    summary["path"] = path_to_json(test.path);
    const dem::Packing end = dem::read_state(options.output / "end.state").packing;
    dem::write_spheres(options.output / "end.csv", end);
    files.emplace_back("end.csv");
    summary["cell"] = cell_to_json(end.H);
  }
  summary["end"] = end_values(rows.back());
  summary["undefined"] = reasons_of(summary["end"]);
  summary["cost"] = OrderedJson(record.at("cost"));
  summary["warnings"] = OrderedJson(record.at("warnings"));
  summary["files"] = files;
  summary["provenance"] = provenance(session);
  write_json(options.output / "simulation.json", summary);

  for (const Json& warning : record.at("warnings")) session.watch.log("warning: " + warning.get<std::string>());
  if (session.json) {
    print_result(json_text(summary));
    return ExitCode::ok;
  }
  std::string text =
      fmt::format("{} spheres, {} rows, end of the {}:\n", record.at("packing").at("particles").get<std::int64_t>(),
                  rows.size(), prepared ? "unloading branch" : "path");
  for (const auto& value : summary["end"].items()) {
    text += fmt::format("  {:<18} {}\n", value.key(),
                        value.value().is_null() ? "undefined" : value_text(value.value().get<double>()));
  }
  text += fmt::format("in {}\n", (options.output / "simulation.json").string());
  print_result(text);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
