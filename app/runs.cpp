#include "app/runs.hpp"

#include <fmt/format.h>

#include "app/files/path_json.hpp"
#include "app/files/preparation_json.hpp"
#include "app/files/series_csv.hpp"
#include "app/files/spec_file.hpp"
#include "app/provenance.hpp"
#include "dem/state_file.hpp"
#include "model/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// A preparation as its tests depend on it: without rows and without the list of states that were kept on the way.
Json packing_identity(const dem::PreparationOptions& o) {
  Json identity = preparation_to_json(o);
  identity.erase("rows");
  identity["seed"] = o.packing.seed;
  identity["nu_gas"] = o.nu_gas;
  identity["gas_compression_factor"] = o.gas_compression_factor;
  identity["relax_tolerance"] = o.relax.tolerance;
  identity["relax_max_passes"] = o.relax.max_passes;
  return identity;
}

OrderedJson packing_to_json(const dem::State& state, const dem::PackingOptions& options, bool prepared) {
  return {{"seed", state.seed},
          {"particles", state.packing.size()},
          {"size_width", prepared ? OrderedJson(options.size_width) : OrderedJson(nullptr)},
          {"mean_radius", dem::mean_radius(state.packing)},
          {"stiffness", state.material.stiffness}};
}

OrderedJson relaxation_to_json(const dem::Relaxation& r) {
  return {{"relaxed", r.relaxed},
          {"max_net_force", r.max_net_force},
          {"mean_contact_force", r.mean_contact_force},
          {"passes", r.passes}};
}

OrderedJson cost_to_json(const RunCost& cost) {
  return {{"steps", cost.steps}, {"time_step", cost.time_step}, {"seconds", cost.seconds}};
}

/// Collects what a preparation yields into its folder.
class PreparationFolder {
 public:
  PreparationFolder(fs::path folder, std::string key, const dem::PreparationOptions& options)
      : folder_(std::move(folder)), key_(std::move(key)), options_(options) {}

  dem::PreparationSink sink() {
    dem::PreparationSink sink;
    sink.keep = [this](const dem::KeptState& kept) { keep(kept); };
    sink.series = [this](Branch branch, const std::vector<Observation>& rows) {
      write_series(folder_ / fmt::format("{}.csv", to_string(branch)), rows);
    };
    sink.warn = [this](const std::string& warning) { warnings_.push_back(warning); };
    return sink;
  }

  OrderedJson record(const Stopwatch& stopwatch) const {
    return {{"kind", "preparation"},
            {"packing", packing_},
            {"states", states_},
            {"warnings", warnings_},
            {"cost", cost_to_json({0, 0, stopwatch.seconds()})},
            {"provenance", provenance("preparation", options_.engine.threads, stopwatch)}};
  }

 private:
  void keep(const dem::KeptState& kept) {
    dem::State state = kept.state;
    state.digest = key_;
    const std::string file = kept_file(kept.branch, kept.nu);
    dem::write_state(folder_ / file, state);
    states_.push_back({{"branch", to_string(kept.branch)},
                       {"nu", kept.nu},
                       {"file", file},
                       {"relaxation", relaxation_to_json(kept.relaxation)}});
    if (!kept.relaxation.relaxed) {
      warnings_.push_back(fmt::format(
          "state at nu = {} of the {} branch: not relaxed, max net force {:.3g} of the mean contact force", kept.nu,
          to_string(kept.branch), kept.relaxation.max_net_force / kept.relaxation.mean_contact_force));
    }
    packing_ = packing_to_json(state, options_.packing, true);
  }

  fs::path folder_;
  std::string key_;
  const dem::PreparationOptions& options_;
  OrderedJson packing_, states_ = OrderedJson::array();
  std::vector<std::string> warnings_;
};

dem::State start_state(const RunStore& store, const TestStart& start, const Path& path, const RunControl& control) {
  if (!start.given) {
    const fs::path run = store.folder(run_key(preparation_request(start.preparation)));
    return dem::read_state(run / kept_file(path.branch, path.nu));
  }
  dem::State state = *start.given;
  if (!start.relax) return state;
  const dem::Relaxation relaxation = dem::relax(state, start.preparation.engine, start.preparation.relax, control);
  if (!relaxation.relaxed) {
    throw NotConverged(
        fmt::format("relaxation of the given spheres: max net force {:.3g} N after {} passes; set relax to false to "
                    "test them as they are",
                    relaxation.max_net_force, relaxation.passes));
  }
  return state;
}

}  // namespace

std::string kept_file(Branch branch, double nu) {
  return fmt::format("{}-{}.state", to_string(branch), density_text(nu));
}

Json preparation_request(const dem::PreparationOptions& o) {
  Json request{{"kind", "preparation"}, {"packing", packing_identity(o)}, {"rows", o.rows}};
  request["keep_loading"] = o.keep_loading;
  request["keep_unloading"] = o.keep_unloading;
  return request;
}

Json test_request(const TestStart& start, const Path& path) {
  Json request{{"kind", "test"}, {"path", Json(path_to_json(path))}, {"rows", start.rows}};
  if (!start.given) {
    request["packing"] = packing_identity(start.preparation);
    return request;
  }
  const Json all = preparation_to_json(start.preparation);
  request["given"] = {{"sha256", start.given_digest}, {"relax", start.relax}};
  for (const char* key : {"time_step_fraction", "skin", "strain_rate", "driving", "transport", "density", "stiffness",
                          "contact_viscosity", "background_viscosity"}) {
    request["given"][key] = all[key];
  }
  return request;
}

Json ensure_preparation(const RunStore& store, const dem::PreparationOptions& options, const RunControl& control) {
  const Json request = preparation_request(options);
  const std::string key = run_key(request);
  if (auto record = store.find(key)) return *record;
  const Stopwatch stopwatch;
  PreparationFolder folder(store.begin(key), key, options);
  dem::prepare(options, folder.sink(), control);
  store.finish(key, request, folder.record(stopwatch));
  return store.find(key).value();
}

Json ensure_test(const RunStore& store, const TestStart& start, const Path& path, const RunControl& control) {
  const Json request = test_request(start, path);
  const std::string key = run_key(request);
  if (auto record = store.find(key)) return *record;
  const Stopwatch stopwatch;
  const dem::State state = start_state(store, start, path, control);
  dem::ElementTestOptions options;
  options.engine = start.preparation.engine;
  options.drive = start.preparation.drive;
  options.rows = start.rows;
  const dem::ElementTest test = dem::run_element_test(state, resolve(path), options, control);
  const fs::path folder = store.begin(key);
  write_series(folder / "series.csv", test.rows);
  dem::State end = test.end;
  end.digest = key;
  dem::write_state(folder / "end.state", end);
  store.finish(key, request,
               {{"kind", "test"},
                {"packing", packing_to_json(state, start.preparation.packing, !start.given)},
                {"warnings", test.warnings},
                {"cost", cost_to_json({test.steps, test.time_step, stopwatch.seconds()})},
                {"provenance", provenance("element test", start.preparation.engine.threads, stopwatch)}});
  return store.find(key).value();
}

PackingInfo packing_from_record(const Json& record) {
  const Json& packing = record.at("packing");
  PackingInfo info;
  info.seed = packing.at("seed");
  info.particles = packing.at("particles");
  if (!packing.at("size_width").is_null()) info.size_width = packing.at("size_width");
  info.mean_radius = packing.at("mean_radius");
  info.stiffness = packing.at("stiffness");
  return info;
}

RunCost cost_from_record(const Json& record) {
  const Json& cost = record.at("cost");
  return {cost.at("steps"), cost.at("time_step"), cost.at("seconds")};
}

}  // namespace grainlaw::app
