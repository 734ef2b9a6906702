#include "dem/runs/runs.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/files/fields_json.hpp"
#include "model/files/path_json.hpp"
#include "dem/runs/preparation_json.hpp"
#include "model/files/series_csv.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/provenance.hpp"
#include "dem/runs/checkpoint_files.hpp"
#include "dem/runs/path_probes.hpp"
#include "dem/runs/preparation_folder.hpp"
#include "dem/files/state_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

/// A preparation as its tests depend on it: without rows and without the list of states that were kept on the way.
Json packing_identity(const PreparationOptions& o) {
  Json identity = preparation_to_json(o, true);
  if (o.drive.quasi_static_step == 0) {  // else rows are part of how the steps are cut
    identity.erase("rows");
    identity.erase("quasi_static_step");
  }
  return identity;
}

State start_state(const RunStore& store, const TestStart& start, const Path& path, const RunControl& control) {
  if (!start.given) {
    const fs::path run = store.folder(run_key(preparation_request(start.preparation)));
    return read_state(run / kept_file(path.branch, path.nu));
  }
  State state = *start.given;
  if (!start.relax) return state;
  const Relaxation relaxation = relax(state, start.preparation.engine, start.preparation.relax, control);
  if (!relaxation.relaxed) {
    throw NotConverged(
        fmt::format("relaxation of the given spheres: max net force {:.3g} N after {} passes; set relax to false to "
                    "test them as they are",
                    relaxation.max_net_force, relaxation.passes));
  }
  return state;
}

}  // namespace

Json preparation_request(const PreparationOptions& o) {
  Json request{{"kind", "preparation"}, {"packing", packing_identity(o)}, {"rows", o.rows}};
  request["keep_loading"] = o.keep_loading;
  request["keep_unloading"] = o.keep_unloading;
  return request;
}

Json test_request(const TestStart& start, const Path& path) {
  Json request{{"kind", "test"}, {"path", Json(path_to_json(path))}, {"rows", start.rows}};
  if (start.probes) request["probes"] = Json(probes_to_json(*start.probes));
  if (!start.given) {
    request["packing"] = packing_identity(start.preparation);
    return request;
  }
  Json& given = request["given"] = {{"sha256", start.given_digest}, {"relax", start.relax}};
  given.update(Json(fields_to_json(start.preparation.packing.material)));
  given.update(Json(fields_to_json(start.preparation.engine)));
  given.update(Json(fields_to_json(start.preparation.drive)));
  if (start.preparation.drive.quasi_static_step == 0) given.erase("quasi_static_step");
  return request;
}

Json ensure_preparation(const RunStore& store, const PreparationOptions& options, const ResumePolicy& policy,
                        const RunControl& control) {
  const Json request = preparation_request(options);
  const std::string key = run_key(request);
  if (auto record = store.find(key)) return *record;
  const Stopwatch stopwatch;
  const fs::path run = policy.resume ? store.reopen(key) : store.begin(key);
  const CheckpointFiles checkpoints(run, key, policy);
  PreparationFolder folder(run, key);
  auto checkpoint = checkpoints.load();
  if (checkpoint && !folder.take_up()) {
    if (policy.log) policy.log("starts anew: what it had yielded before the checkpoint is damaged or missing");
    checkpoint.reset();
  }
  if (!checkpoint) store.begin(key);
  const double earlier = checkpoint ? checkpoint->seconds : 0;
  if (checkpoint) {
    continue_preparation(std::move(*checkpoint), options, folder.sink(), control, checkpoints.checkpointing());
  } else {
    prepare(options, folder.sink(), control, checkpoints.checkpointing());
  }
  store.finish(key, request,
               {{"kind", "preparation"},
                {"packing", folder.packing(options.packing)},
                {"states", folder.states()},
                {"warnings", folder.warnings()},
                {"cost", fields_to_json(RunCost{0, 0, earlier + stopwatch.seconds()})},
                {"provenance", provenance("preparation", options.engine.threads, stopwatch)}});
  return store.find(key).value();
}

Json ensure_test(const RunStore& store, const TestStart& start, const Path& path, const ResumePolicy& policy,
                 const RunControl& control) {
  const Json request = test_request(start, path);
  const std::string key = run_key(request);
  if (auto record = store.find(key)) return *record;
  const Stopwatch stopwatch;
  ElementTestOptions options;
  options.engine = start.preparation.engine;
  options.drive = start.preparation.drive;
  options.relax = start.preparation.relax;
  options.rows = start.rows;
  const fs::path folder = policy.resume ? store.reopen(key) : store.begin(key);
  const CheckpointFiles checkpoints(folder, key, policy);
  const auto segments = resolve(path);
  std::optional<PathProbes> probes;
  if (start.probes) probes.emplace(folder, *start.probes, segments, start.preparation.engine.threads, control);
  auto checkpoint = checkpoints.load();
  if (checkpoint && probes && !probes->take_up()) {
    if (policy.log) policy.log("starts anew: what was probed before the checkpoint is damaged");
    checkpoint.reset();
  }
  if (!checkpoint) store.begin(key);
  const double earlier = checkpoint ? checkpoint->seconds : 0;
  const StepObserver on_step = probes ? probes->observer() : StepObserver{};
  const ElementTest test = checkpoint
                                    ? continue_element_test(std::move(*checkpoint), segments, options, control,
                                                                 on_step, checkpoints.checkpointing())
                                    : run_element_test(start_state(store, start, path, control), segments, options,
                                                            control, on_step, checkpoints.checkpointing());
  write_series(folder / "series.csv", test.rows);
  std::vector<std::string> warnings = test.warnings;
  if (probes) {
    probes->finish(test.end);
    warnings.insert(warnings.end(), probes->warnings().begin(), probes->warnings().end());
  }
  State end = test.end;
  end.digest = key;
  write_state(folder / "end.state", end);
  const auto width = start.given ? std::nullopt : std::optional(start.preparation.packing.size_width);
  store.finish(key, request,
               {{"kind", "test"},
                {"packing", packing_to_json(end, width)},
                {"warnings", warnings},
                {"cost", fields_to_json(RunCost{test.steps, test.time_step, earlier + stopwatch.seconds()})},
                {"provenance", provenance("element test", start.preparation.engine.threads, stopwatch)}});
  return store.find(key).value();
}

PackingInfo packing_from_record(const Json& record) {
  PackingInfo info;
  read_fields(record.at("packing"), info);
  if (std::isnan(info.size_width)) info.size_width = 0;  // of given spheres
  return info;
}

RunCost cost_from_record(const Json& record) {
  RunCost cost;
  read_fields(record.at("cost"), cost);
  return cost;
}

}  // namespace grainlaw::dem
