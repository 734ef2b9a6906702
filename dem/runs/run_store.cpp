#include "dem/runs/run_store.hpp"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "model/files/dataset.hpp"
#include "model/files/digest.hpp"
#include "model/files/execution.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

namespace fs = std::filesystem;

namespace {

/// Besides the named ones, what a killed writer left under a temporary name.
bool is_scratch(const std::string& name) {
  return name == kCheckpoint || name == kPreviousCheckpoint || name == kProgress || name.starts_with('.');
}

/// Whether the record has what is read of it later: numbers of the packing (null: of a preparation that kept none), cost.
bool is_whole(const Json& record) {
  PackingInfo packing;
  RunCost cost;
  read_fields(record.at("cost"), cost);
  record.at("warnings").get<std::vector<std::string>>();
  if (record.at("packing").is_null()) return true;
  read_fields(record.at("packing"), packing);
  return packing.particles > 0 && packing.mean_radius > 0 && packing.stiffness > 0;
}

void remove_scratch(const fs::path& run) {
  std::error_code ignored;  // what stays is no part of the run
  for (const char* name : {kCheckpoint, kPreviousCheckpoint, kProgress}) fs::remove(run / name, ignored);
  std::vector<fs::path> scratch;
  for (const auto& entry : fs::directory_iterator(run, ignored)) {
    if (is_scratch(entry.path().filename().string())) scratch.push_back(entry.path());
  }
  for (const fs::path& file : scratch) fs::remove(file, ignored);
}

/// Of a run.json without its own digest.
std::string digest_of(Json record) {
  record.erase("sha256");
  return sha256(record.dump());
}

}  // namespace

std::string run_key(const Json& request) {
  return sha256(Json{{"engine_version", kEngineVersion}, {"request", request}}.dump());
}

bool is_finished(const fs::path& folder, const std::string& key) {
  std::error_code error;  // what cannot be looked at is run again
  return fs::exists(folder / key / "run.json", error);
}

std::optional<std::string> maker_of(const fs::path& folder, const std::string& key) {
  return lock_owner(folder / (key + ".lock"));
}

RunStore::RunStore(const fs::path& parent, const std::string& name) : root_(make_subfolder(parent, name)) {
  remove_dead_locks(root_);
}

RunStore::~RunStore() {
  std::error_code not_empty;  // a store that nobody has put anything into leaves nothing
  fs::remove(root_, not_empty);
}

fs::path RunStore::folder(const std::string& key) const { return root_ / key; }

std::unique_ptr<ProcessLock> RunStore::try_lock(const std::string& key) const {
  std::error_code none;
  fs::create_directory(root_, none);  // another may have left nothing and taken it along
  auto lock = ProcessLock::try_lock(root_ / (key + ".lock"));
  // opening it makes a network file system look again for what others have finished there
  if (lock) fs::directory_iterator(folder(key), none);
  return lock;
}

std::optional<Json> RunStore::find(const std::string& key) const {
  const fs::path run = folder(key);
  if (!fs::exists(run / "run.json")) return std::nullopt;
  try {
    Json record = read_json(run / "run.json", JsonSource::own);
    if (record.at("key") != key || !is_whole(record)) return std::nullopt;
    if (record.at("format_version") != 1 && record.at("sha256") != digest_of(record)) return std::nullopt;
    for (const auto& file : record.at("files").items()) {
      if (!is_safe_name(file.key()) || sha256_of_file(run / file.key()) != file.value()) return std::nullopt;
    }
    remove_scratch(run);
    return record;
  } catch (const InvalidInput&) {
    return std::nullopt;  // damaged: it is run again
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

Json RunStore::finished(const std::string& key) const {
  if (auto record = find(key)) return std::move(*record);
  throw Error(fmt::format("{}: is damaged or gone since; the same command makes it again", folder(key).string()));
}

std::optional<fs::path> RunStore::set_aside_damaged(const std::string& key) const {
  const fs::path run = folder(key), aside = folder(key + ".damaged");
  if (!fs::exists(run / "run.json") || find(key)) return std::nullopt;
  std::error_code error;
  fs::remove_all(aside, error);
  fs::rename(run, aside, error);
  if (error) throw Error(fmt::format("{}: is damaged and cannot be put aside: {}", run.string(), error.message()));
  return run / "run.json";
}

fs::path RunStore::begin(const std::string& key) const {
  std::error_code error;
  fs::remove_all(folder(key), error);  // what stayed would count as the run's own
  if (error) throw Error(fmt::format("{}: cannot be removed: {}", folder(key).string(), error.message()));
  return make_subfolder(root_, key);
}

fs::path RunStore::reopen(const std::string& key) const { return make_subfolder(root_, key); }

Json RunStore::finish(const std::string& key, const Json& request, const OrderedJson& record) const {
  const fs::path run = folder(key);
  OrderedJson document{{"format", "grainlaw run"}, {"format_version", 2}, {"key", key}};
  for (const auto& item : record.items()) document[item.key()] = item.value();
  document["request"] = OrderedJson(request);
  OrderedJson& files = document["files"] = OrderedJson::object();
  std::map<std::string, std::string> sums;
  for (const auto& entry : fs::directory_iterator(run)) {
    const std::string name = entry.path().filename().string();
    if (!is_scratch(name)) sums[name] = sha256_of_file(entry.path());
  }
  for (const auto& [name, sum] : sums) files[name] = sum;
  Json as_read = Json::parse(json_text(document));
  document["sha256"] = as_read["sha256"] = digest_of(as_read);
  write_json(run / "run.json", document);
  remove_scratch(run);
  return as_read;
}

}  // namespace grainlaw::dem
