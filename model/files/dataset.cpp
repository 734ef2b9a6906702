#include "model/files/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "model/files/digest.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/series_check.hpp"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// What the digest of a data set covers of a test.
OrderedJson identity(const DatasetTest& test) {
  OrderedJson identity{{"name", test.record.name},
                       {"role", to_string(test.record.role)},
                       {"path", path_to_json(test.record.path)},
                       {"packing", fields_to_json(test.record.packing)},
                       {"sha256", test.sha256}};
  identity["packing"].update(changed_fields(test.record.packing.contacts));
  if (!test.probes_sha256.empty()) identity["probes_sha256"] = test.probes_sha256;
  return identity;
}

std::string digest_of(const Dataset& dataset) {
  Json identities = Json::array();
  for (const DatasetTest& test : dataset.tests) identities.push_back(Json(identity(test)));
  return sha256(identities.dump());
}

std::vector<std::uint64_t> seeds_of(const Dataset& dataset) {
  std::set<std::uint64_t> seeds;
  for (const DatasetTest& test : dataset.tests) seeds.insert(test.record.packing.seed);
  return {seeds.begin(), seeds.end()};
}

DatasetTest read_test(const Json& object, const fs::path& folder, const std::string& index, const std::string& place) {
  DatasetTest test;
  test.record.name = object["name"];
  test.record.role = value_of<Role>(object["role"].get<std::string>(), "role");
  test.record.path = path_from_json(object["path"], index, place + ".path.", true);
  read_given_fields(object["packing"], test.record.packing);
  read_given_fields(object["packing"], test.record.packing.contacts);
  const fs::path file = folder / (test.record.name + ".csv");
  test.record.rows = read_series(file, test.record.path, test.record.packing);
  test.sha256 = sha256_of_file(file);
  if (object.contains("sha256") && object["sha256"] != test.sha256) {
    throw InvalidInput(
        fmt::format("{}: is not the file that {} was written with (SHA-256 differs); restore it, or remove {}.sha256 "
                    "and digest from {} to accept it",
                    file.string(), index, place, index));
  }
  check_series(test.record.rows, test.record.path, test.record.packing, one_line(file.string(), 200));
  test.probes_sha256 = object.value("probes_sha256", "");
  const fs::path probes = folder / kProbesFolder / (test.record.name + ".csv");
  if (!test.probes_sha256.empty() && sha256_of_file(probes) != test.probes_sha256) {
    throw InvalidInput(fmt::format("{}: is not the file that {} was written with (SHA-256 differs); restore it",
                                   probes.string(), index));
  }
  test.run = object.value("run", "");
  if (object.contains("cost")) read_given_fields(object["cost"], test.cost);
  if (object.contains("warnings")) test.warnings = object["warnings"].get<std::vector<std::string>>();
  return test;
}

/// A path without the names of its directions.
Json driving_of(const Path& path) {
  Json driving = path_to_json(path);
  for (Json& segment : driving["segments"]) segment.erase("mode");
  return driving;
}

}  // namespace

Dataset read_dataset(const fs::path& folder) {
  const fs::path index = folder / "dataset.json";
  const std::string name = one_line(index.string(), 200);
  const Json document = read_json(index, JsonSource::own);
  check_schema(document, Schema::dataset, name);
  Dataset dataset;
  std::set<std::string> names;
  for (std::size_t i = 0; i < document["tests"].size(); ++i) {
    const Json& object = document["tests"][i];
    const std::string place = fmt::format("tests[{}]", i);
    if (!names.insert(object["name"]).second) {
      throw InvalidInput(
          fmt::format("{}: {}.name: '{}' is given twice; rename one", name, place, object["name"].get<std::string>()));
    }
    dataset.tests.push_back(read_test(object, folder, name, place));
  }
  dataset.spec = document.value("spec", Json());
  dataset.provenance = document.value("provenance", Json());
  if (document.contains("seeds")) {
    dataset.seeds = document["seeds"].get<std::vector<std::uint64_t>>();
  } else {
    dataset.seeds = seeds_of(dataset);
  }
  require_judges(dataset, dataset, name);
  dataset.digest = digest_of(dataset);
  if (document.contains("digest") && document["digest"] != dataset.digest) {
    throw InvalidInput(fmt::format("{}: digest: does not match the tests, which give {}; remove the key to accept them",
                                   name, dataset.digest));
  }
  return dataset;
}

std::vector<TestRecord> tests_of(const Dataset& dataset, Role role) {
  std::vector<TestRecord> tests;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == role) tests.push_back(test.record);
  }
  return tests;
}

void write_dataset_index(const fs::path& folder, Dataset& dataset) {
  OrderedJson tests = OrderedJson::array();
  for (DatasetTest& test : dataset.tests) {
    test.sha256 = sha256_of_file(folder / (test.record.name + ".csv"));
    OrderedJson object = identity(test);
    for (const char* key : {"size_width", "particles"}) {  // unknown
      if (object["packing"][key] == 0) object["packing"].erase(key);
    }
    object["rows"] = test.record.rows.size();
    if (!test.run.empty()) object["run"] = test.run;
    object["cost"] = fields_to_json(test.cost);
    object["warnings"] = test.warnings;
    tests.push_back(object);
  }
  dataset.digest = digest_of(dataset);
  OrderedJson document = OrderedJson::object();
  document["format"] = "grainlaw dataset";
  document["format_version"] = 1;
  document["digest"] = dataset.digest;
  if (dataset.seeds.empty()) dataset.seeds = seeds_of(dataset);
  if (!dataset.seeds.empty()) document["seeds"] = dataset.seeds;
  if (!dataset.spec.is_null()) document["spec"] = OrderedJson(dataset.spec);
  if (!dataset.provenance.is_null()) document["provenance"] = OrderedJson(dataset.provenance);
  document["tests"] = tests;
  write_json(folder / "dataset.json", document);
}

fs::path dataset_folder(const fs::path& given) {
  for (const fs::path& folder : {given, given / "dataset", given / "dem"}) {
    if (fs::exists(folder / "dataset.json")) return folder;
  }
  throw InvalidInput(fmt::format("{}: holds no dataset.json; give the folder of a data set", given.string()));
}

std::set<std::string> series_listed(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder / "dataset.json")) return names;
  try {
    const Json index = read_json(folder / "dataset.json", JsonSource::own);
    for (const Json& test : index.at("tests")) names.insert(test.at("name"));
  } catch (const Json::exception&) {
    names.clear();
  } catch (const InvalidInput&) {
    names.clear();  // damaged: it is replaced, and what it listed is left alone
  }
  return names;
}

void remove_stale_series(const fs::path& folder, const std::set<std::string>& listed, const Dataset& dataset) {
  std::set<std::string> stale = listed, stale_probes = listed;
  for (const DatasetTest& test : dataset.tests) {
    stale.erase(test.record.name);
    if (!test.probes_sha256.empty()) stale_probes.erase(test.record.name);
  }
  for (const std::string& name : stale) {
    if (is_safe_name(name)) fs::remove(folder / (name + ".csv"));
  }
  for (const std::string& name : stale_probes) {
    if (is_safe_name(name)) fs::remove(folder / kProbesFolder / (name + ".csv"));
  }
}

Dataset adopt(const Dataset& dataset, const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (fs::equivalent(from, to, error)) return dataset;
  const std::set<std::string> listed = series_listed(to);
  for (const DatasetTest& test : dataset.tests) {
    const std::string file = test.record.name + ".csv";
    copy_durably(from / file, to / file);
    if (!test.probes_sha256.empty())
      copy_durably(from / kProbesFolder / file, make_subfolder(to, kProbesFolder) / file);
  }
  copy_durably(from / "dataset.json", to / "dataset.json");
  remove_stale_series(to, listed, dataset);
  return read_dataset(to);
}

std::optional<Dataset> fitted_dataset(const fs::path& parameters, const std::string& digest) {
  const fs::path beside = parameters.parent_path() / "dataset";
  if (!fs::exists(beside / "dataset.json")) return std::nullopt;
  Dataset dataset = read_dataset(beside);
  if (!digest.empty() && dataset.digest != digest) return std::nullopt;
  return dataset;
}

void require_judges(const Dataset& runs, const Dataset& fitted, const std::string& name) {
  for (const DatasetTest& test : runs.tests) {
    if (test.record.role != Role::validation && test.record.role != Role::rehearsal) continue;
    const bool unjammed = std::ranges::all_of(test.record.rows, [](const Observation& row) { return row.P_star == 0; });
    for (const DatasetTest& other : fitted.tests) {
      if (other.record.role != Role::calibration) continue;
      const std::string differs = other_material(test.record.packing, other.record.packing);
      if (!differs.empty()) {
        throw InvalidInput(
            fmt::format("{}: test {}: {} in test {}, which is fitted; a law is of one material, calibrate "
                        "one for the other",
                        name, test.record.name, differs, other.record.name));
      }
      if (unjammed || other.sha256 != test.sha256) continue;  // unjammed tests may well agree
      throw InvalidInput(
          fmt::format("{}: test {} ({}) holds the series of test {}, which is fitted; what is fitted cannot judge the "
                      "law, remove one",
                      name, test.record.name, to_string(test.record.role), other.record.name));
    }
  }
}

void require_runs_of(const Path& path, const Dataset& dataset, const std::string& name) {
  for (const DatasetTest& test : dataset.tests) {
    const TestRecord& record = test.record;
    if (record.role == Role::calibration) {
      throw InvalidInput(
          fmt::format("{}: test {} is of role calibration; a prediction is compared with runs that no fit "
                      "has seen",
                      name, record.name));
    }
    if (driving_of(record.path) != driving_of(path)) {
      throw InvalidInput(fmt::format("{}: test {} follows another path ({}); give runs of the predicted path", name,
                                     record.name, path_to_json(record.path).dump()));
    }
  }
}

}  // namespace grainlaw
