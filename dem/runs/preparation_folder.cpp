#include "dem/runs/preparation_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dem/files/state_file.hpp"
#include "dem/runs/run_store.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/digest.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

OrderedJson relaxation_to_json(const Relaxation& r) {
  return {{"relaxed", r.relaxed},
          {"max_net_force", r.max_net_force},
          {"mean_contact_force", r.mean_contact_force},
          {"passes", r.passes}};
}

}  // namespace

std::string kept_file(Branch branch, double nu) {
  return fmt::format("{}-{}.state", to_string(branch), density_text(nu));
}

std::string history_file(Branch branch, double nu) {
  return fmt::format("{}-{}.restart", to_string(branch), density_text(nu));
}

OrderedJson packing_to_json(const State& state, std::optional<double> size_width) {
  return fields_to_json(PackingInfo{state.seed, static_cast<std::int64_t>(state.packing.size()),
                                    size_width.value_or(Observation::undefined), mean_radius(state.packing),
                                    state.material.stiffness});
}

PreparationFolder::PreparationFolder(std::filesystem::path folder, std::string key, const ContactModel& contacts)
    : folder_(std::move(folder)), key_(std::move(key)), contacts_(contacts) {
  progress_["states"] = OrderedJson::array();
  progress_["warnings"] = OrderedJson::array();
  progress_["files"] = OrderedJson::object();
}

bool PreparationFolder::take_up() {
  if (!std::filesystem::exists(folder_ / kProgress)) return true;  // nothing was yielded yet
  try {
    OrderedJson progress(read_json(folder_ / kProgress, JsonSource::own));
    for (const auto& file : progress.at("files").items()) {
      if (!is_safe_name(file.key()) || sha256_of_file(folder_ / file.key()) != file.value()) return false;
    }
    for (const auto& state : progress.at("states")) {
      if (!progress.at("files").contains(state.at("file").get<std::string>())) return false;
    }
    if (!progress.at("warnings").is_array()) return false;
    progress_ = std::move(progress);
    return true;
  } catch (const InvalidInput&) {
    return false;
  } catch (const Json::exception&) {
    return false;
  }
}

PreparationSink PreparationFolder::sink() {
  PreparationSink sink;
  sink.keep = [this](const KeptState& kept) { keep(kept); };
  sink.series = [this](Branch branch, const std::vector<Observation>& rows) { series(branch, rows); };
  sink.warn = [this](const std::string& warning) {
    warn(warning);
    save();
  };
  sink.has = [this](Branch branch, double nu) { return progress_.at("files").contains(kept_file(branch, nu)); };
  return sink;
}

OrderedJson PreparationFolder::packing(const PackingOptions& options) const {
  if (progress_.at("states").empty()) return nullptr;
  const auto file = progress_.at("states").front().at("file").get<std::string>();
  return packing_to_json(read_state(folder_ / file), options.size_width);
}

void PreparationFolder::keep(const KeptState& kept) {
  State state = kept.state;
  state.digest = key_;
  state.contacts = contacts_;
  const std::string file = kept_file(kept.branch, kept.nu);
  write_state(folder_ / file, state);
  progress_["states"].push_back({{"branch", to_string(kept.branch)},
                                 {"nu", kept.nu},
                                 {"file", file},
                                 {"relaxation", relaxation_to_json(kept.relaxation)}});
  note_file(file);
  if (!kept.history.empty()) {
    const std::string history = history_file(kept.branch, kept.nu);
    copy_durably(kept.history, folder_ / history);
    note_file(history);
  }
  if (!kept.relaxation.relaxed) {
    warn(fmt::format("state at nu = {} of the {} branch: not relaxed, max net force {:.3g} of the mean contact force",
                     kept.nu, to_string(kept.branch),
                     kept.relaxation.max_net_force / kept.relaxation.mean_contact_force));
  }
  save();
}

void PreparationFolder::series(Branch branch, const std::vector<Observation>& rows) {
  const std::string file = fmt::format("{}.csv", to_string(branch));
  write_series(folder_ / file, rows);
  note_file(file);
  save();
}

void PreparationFolder::warn(const std::string& warning) {
  auto& warnings = progress_["warnings"];
  // a continued preparation repeats those of the stage that it goes on with
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
}

void PreparationFolder::note_file(const std::string& name) {
  progress_["files"][name] = sha256_of_file(folder_ / name);
}

void PreparationFolder::save() const { write_json(folder_ / kProgress, progress_); }

}  // namespace grainlaw::dem
