#include "dem/runs/runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/files/state_file.hpp"
#include "dem/lammps/lammps_preparation.hpp"
#include "dem/runs/feasibility.hpp"
#include "dem/runs/path_frames.hpp"
#include "dem/runs/preparation_folder.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

/// Portable runs of versions that took the C library's functions are not these.
void name_functions(Json& request, const EngineOptions& engine) {
  if (engine.portable_bits) request["elementary_functions"] = "own";
}

/// What the other engine does not read of a request.
void name_engine(Json& request, const EngineChoice& choice) {
  if (choice.is_lammps()) {
    for (const char* key : kOurEngineAlone) request.erase(key);
    request["deck_version"] = kDeckVersion;
  } else {
    for_each_field<ContactModel>([&](const auto& field) { request.erase(field.name); });
    request.erase("engine");
  }
}

/// A preparation as its tests depend on it: without rows and without the list of states that were kept on the way.
Json packing_identity(const PreparationOptions& o) {
  Json identity = fields_to_json(o, true);
  name_functions(identity, o.engine);
  if (!o.nu_end) identity["nu_end"] = o.nu_start;
  if (o.drive.quasi_static_step == 0) {  // else rows are part of how the steps are cut
    identity.erase("rows");
    identity.erase("quasi_static_step");
  }
  name_engine(identity, o.choice);
  return identity;
}

State start_state(const RunStore& store, const TestSetup& test, const RunControl& control) {
  if (!test.given)
    return read_state(store.folder(preparation_key(test.preparation)) / kept_file(test.path.branch, test.path.nu));
  State state = *test.given;
  if (!test.relax) return state;
  const Relaxation relaxation = relax(state, test.preparation.engine, test.preparation.relax, control);
  if (!relaxation.relaxed) {
    throw NotConverged(
        fmt::format("relaxation of the given spheres: max net force {:.3g} N after {} passes; set relax to false to "
                    "test them as they are",
                    relaxation.max_net_force, relaxation.passes));
  }
  return state;
}

Json request_of(const PreparationOptions& o) {
  Json request{{"kind", "preparation"}, {"packing", packing_identity(o)}, {"rows", o.rows}};
  request["keep_loading"] = o.keep_loading;
  request["keep_unloading"] = o.keep_unloading;
  return request;
}

Json request_of(const TestSetup& test) {
  const PreparationOptions& o = test.preparation;
  Json request{{"kind", "test"}, {"path", Json(path_to_json(test.path))}, {"rows", test.rows}};
  if (test.probes) request["probes"] = Json(fields_to_json(*test.probes));
  if (test.frames > 0) request["frames"] = test.frames;
  if (!test.given) {
    request["packing"] = packing_identity(o);
    return request;
  }
  Json& given = request["given"] = {{"sha256", test.given_digest}, {"relax", test.relax}};
  given.update(Json(fields_to_json(o.packing.material)));
  given.update(Json(fields_to_json(o.engine)));
  given.update(Json(fields_to_json(o.drive)));
  name_functions(given, o.engine);
  if (o.drive.quasi_static_step == 0) given.erase("quasi_static_step");
  given.update(Json(fields_to_json(o.choice)));
  name_engine(given, o.choice);
  return request;
}

/// Where LAMMPS works on a run, and what its provenance says of it.
constexpr const char* kScratch = ".lammps";
LammpsPlace lammps_place(const fs::path& run, const ResumePolicy& policy) {
  LammpsPlace place{run / kScratch, find_lammps(policy.lammps, policy.launcher), policy.log};
  if (!place.program.is_known() && place.log)
    place.log(
        fmt::format("warning: LAMMPS of {} was not tried with these decks, {} was; each force is held against its law",
                    place.program.version, kKnownLammps));
  fs::create_directories(place.folder);
  return place;
}
/// Whether LAMMPS can go on from a checkpoint of such a run.
bool can_go_on(const fs::path& run, const std::optional<Checkpoint>& checkpoint, const EngineChoice& choice,
               const ResumePolicy& policy) {
  if (!checkpoint || !choice.is_lammps() || fs::exists(run / kScratch / restart_of(*checkpoint))) return true;
  if (policy.log) policy.log("starts anew: the restart file of LAMMPS that belongs to the checkpoint is gone");
  return false;
}

OrderedJson lammps_provenance(OrderedJson provenance, const std::optional<LammpsPlace>& place) {
  if (place)
    provenance["lammps"] = {{"executable", place->program.executable.string()},
                            {"version", place->program.version},
                            {"launcher", place->program.launcher},  // the last digits depend on it
                            {"deck_version", kDeckVersion}};
  return provenance;
}

/// The finished run; a damaged one is put aside and said to be.
std::optional<Json> sound_run(const RunStore& store, const std::string& key, const ResumePolicy& policy) {
  if (auto record = store.find(key)) return record;
  if (const auto damaged = store.set_aside_damaged(key); damaged && policy.log)
    policy.log(fmt::format("{}: damaged; put aside as {}.damaged, simulated again", damaged->string(), key));
  return std::nullopt;
}

OrderedJson with_contacts(OrderedJson packing, const EngineChoice& choice) {
  if (!packing.is_null()) packing.update(changed_fields(choice.contacts));
  return packing;
}

/// As run_element_test() and continue_element_test().
ElementTest run_by_lammps(const LammpsPlace& place, const RunStore& store, const TestSetup& test,
                          const ElementTestOptions& options, std::optional<Checkpoint> checkpoint,
                          const RunControl& control, const Checkpointing& checkpointing) {
  LammpsTest asked;
  asked.name = kTestName;
  asked.segments = resolve(test.path);
  asked.options = options;
  asked.contacts = test.preparation.choice.contacts;
  if (!test.given && !checkpoint && test.preparation.choice.has_history()) {
    asked.restart = "start.restart";  // a copy: words in a deck end at blanks
    copy_durably(store.folder(preparation_key(test.preparation)) / history_file(test.path.branch, test.path.nu),
                 place.folder / asked.restart);
  }
  const State start = checkpoint ? checkpoint->state : start_state(store, test, control);
  ElementTest done = run_lammps_test(place, asked, start, std::move(checkpoint), control, checkpointing).test;
  fs::remove_all(place.folder);
  return done;
}

}  // namespace

std::string preparation_key(const PreparationOptions& options) { return run_key(request_of(options)); }
std::string test_key(const TestSetup& test) { return run_key(request_of(test)); }

double expected_work(const PreparationOptions& options) {
  return static_cast<double>(options.packing.particles) * expected_steps(options);
}

double expected_work(const TestSetup& test) {
  const double particles = test.given ? static_cast<double>(test.given->packing.size())
                                      : static_cast<double>(test.preparation.packing.particles);
  return particles * std::max(1.0, expected_steps(test.preparation, resolve(test.path)));
}

Json ensure_preparation(const RunStore& store, const PreparationOptions& options, const ResumePolicy& policy,
                        const RunControl& control) {
  const Json request = request_of(options);
  const std::string key = run_key(request);
  if (auto record = sound_run(store, key, policy)) return *record;
  const Stopwatch stopwatch;
  const fs::path run = policy.resume ? store.reopen(key) : store.begin(key);
  const CheckpointFiles checkpoints(run, key, policy);
  PreparationFolder folder(run, key, options.choice.contacts);
  auto checkpoint = checkpoints.load();
  if (!can_go_on(run, checkpoint, options.choice, policy)) checkpoint.reset();
  if (checkpoint && !folder.take_up()) {
    if (policy.log) policy.log("starts anew: what it had yielded before the checkpoint is damaged or missing");
    checkpoint.reset();
  }
  if (!checkpoint) store.begin(key);
  const double earlier = checkpoint ? checkpoint->seconds : 0;
  std::optional<LammpsPlace> place;
  if (options.choice.is_lammps()) {
    place = lammps_place(run, policy);
    prepare_with_lammps(*place, options, folder.sink(), std::move(checkpoint), control, checkpoints.checkpointing());
    fs::remove_all(place->folder);
  } else if (checkpoint) {
    continue_preparation(std::move(*checkpoint), options, folder.sink(), control, checkpoints.checkpointing());
  } else {
    prepare(options, folder.sink(), control, checkpoints.checkpointing());
  }
  return store.finish(
      key, request,
      {{"kind", "preparation"},
       {"packing", with_contacts(folder.packing(options.packing), options.choice)},
       {"states", folder.states()},
       {"warnings", folder.warnings()},
       {"cost", fields_to_json(RunCost{0, 0, earlier + stopwatch.seconds()})},
       {"provenance", lammps_provenance(provenance("preparation", options.engine.threads, stopwatch), place)}});
}

Json ensure_test(const RunStore& store, const TestSetup& test, const ResumePolicy& policy, const RunControl& control) {
  const PreparationOptions& o = test.preparation;
  const Json request = request_of(test);
  const std::string key = run_key(request);
  if (auto record = sound_run(store, key, policy)) return *record;
  const Stopwatch stopwatch;
  ElementTestOptions options = test_options(o);
  options.rows = test.rows;
  const fs::path folder = policy.resume ? store.reopen(key) : store.begin(key);
  const CheckpointFiles checkpoints(folder, key, policy);
  const auto segments = resolve(test.path, o.engine.portable_bits);
  std::optional<PathProbes> probes;
  if (test.probes) probes.emplace(folder, *test.probes, segments, o.engine.threads, control);
  std::optional<PathFrames> frames;
  if (test.frames > 0) frames.emplace(folder, test.frames, segments, key);
  auto checkpoint = checkpoints.load();
  if (!can_go_on(folder, checkpoint, o.choice, policy)) checkpoint.reset();
  if (checkpoint && frames && !frames->take_up()) {
    if (policy.log) policy.log("starts anew: a frame that was kept before the checkpoint is damaged");
    checkpoint.reset();
  }
  if (checkpoint && probes && !probes->take_up()) {
    if (policy.log) policy.log("starts anew: what was probed before the checkpoint is damaged");
    checkpoint.reset();
  }
  if (!checkpoint) store.begin(key);
  const double earlier = checkpoint ? checkpoint->seconds : 0;
  const StepObserver to_probes = probes ? probes->observer() : StepObserver{},
                     to_frames = frames ? frames->observer() : StepObserver{};
  const StepObserver to_both = [&](Stepper& stepper, int segment, double e) {
    to_probes(stepper, segment, e);
    to_frames(stepper, segment, e);
  };
  const StepObserver& on_step = probes && frames ? to_both : frames ? to_frames : to_probes;
  Checkpointing checkpointing = checkpoints.checkpointing();
  if (frames) {
    checkpointing.save = [&frames, save = checkpointing.save](const Checkpoint& reached) {
      frames->write_places();
      save(reached);
    };
  }
  std::optional<LammpsPlace> place;
  if (o.choice.is_lammps()) place = lammps_place(folder, policy);
  const ElementTest done =
      place        ? run_by_lammps(*place, store, test, options, std::move(checkpoint), control, checkpointing)
      : checkpoint ? continue_element_test(std::move(*checkpoint), segments, options, control, on_step, checkpointing)
                   : run_element_test(start_state(store, test, control), segments, options, control, on_step,
                                      checkpointing, frames ? frames->at_start() : StepObserver{});
  write_series(folder / "series.csv", done.rows);
  std::vector<std::string> warnings = done.warnings;
  if (probes) {
    probes->finish(done.end);
    warnings.insert(warnings.end(), probes->warnings().begin(), probes->warnings().end());
  }
  State end = done.end;
  end.digest = key;
  end.contacts = o.choice.contacts;
  write_state(folder / "end.state", end);
  if (frames) {
    frames->write_places();
    sync_files_below(folder);
  }
  const auto width = test.given ? std::nullopt : std::optional(o.packing.size_width);
  return store.finish(
      key, request,
      {{"kind", "test"},
       {"packing", with_contacts(packing_to_json(end, width), o.choice)},
       {"warnings", warnings},
       {"cost", fields_to_json(RunCost{done.steps, done.time_step, earlier + stopwatch.seconds()})},
       {"provenance", lammps_provenance(provenance("element test", o.engine.threads, stopwatch), place)}});
}

PackingInfo packing_from_record(const Json& record) {
  PackingInfo info;
  read_fields(record.at("packing"), info);
  read_given_fields(record.at("packing"), info.contacts);
  if (std::isnan(info.size_width)) info.size_width = 0;  // of given spheres
  return info;
}

RunCost cost_from_record(const Json& record) {
  RunCost cost;
  read_fields(record.at("cost"), cost);
  return cost;
}

}  // namespace grainlaw::dem
