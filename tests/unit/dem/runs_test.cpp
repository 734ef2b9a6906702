// Content-addressed runs: keys, store, and the two kinds of run with very small packings.
#include "dem/runs/runs.hpp"

#include <map>

#include "dem/files/state_file.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/feasibility.hpp"
#include "dem/runs/preparation_folder.hpp"
#include "model/files/digest.hpp"
#include "model/files/series_csv.hpp"
#include "tests/support/no_descriptors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

using testing::refusal;
namespace fs = std::filesystem;

dem::PreparationOptions tiny() {
  PreparationOptions options;
  options.packing.particles = 32;
  options.drive.strain_rate = 20000;
  options.rows = 20;
  options.keep_unloading = {0.74};
  options.nu_end = 0.7;
  return options;
}

Path d2(double nu = 0.74) {
  return {nu, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.02}}};
}

class Runs : public testing::TemporaryFolder {};

TEST_F(Runs, KeyHoldsWhatChangesTheResultAndNothingElse) {
  const std::string key = preparation_key(tiny());
  EXPECT_EQ(key.size(), 64u);
  const auto changed = [&](const std::function<void(PreparationOptions&)>& change) {
    PreparationOptions options = tiny();
    change(options);
    return preparation_key(options) != key;
  };
  using O = PreparationOptions;
  EXPECT_FALSE(changed([](O& o) { o.engine.threads = 7; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.particles = 33; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.seed = 2; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.size_width = 2; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.mean_radius *= 1 + 1e-15; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.material.density += 1; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.material.stiffness += 1; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.material.contact_viscosity += 1; }));
  EXPECT_TRUE(changed([](O& o) { o.packing.material.background_viscosity += 1; }));
  EXPECT_TRUE(changed([](O& o) { o.engine.time_step_fraction = 0.09; }));
  EXPECT_TRUE(changed([](O& o) { o.engine.skin = 0.09; }));
  EXPECT_TRUE(changed([](O& o) { o.drive.strain_rate = 1; }));
  EXPECT_TRUE(changed([](O& o) { o.drive.quasi_static_step = 1e-3; }));
  EXPECT_TRUE(changed([](O& o) { o.drive.profile = Profile::constant; }));
  EXPECT_TRUE(changed([](O& o) { o.drive.transport = Transport::wall; }));
  EXPECT_TRUE(changed([](O& o) { o.relax.tolerance = 1e-6; }));
  EXPECT_TRUE(changed([](O& o) { o.relax.max_passes = 5; }));
  EXPECT_TRUE(changed([](O& o) { o.nu_gas = 0.31; }));
  EXPECT_TRUE(changed([](O& o) { o.nu_start = 0.65; }));
  EXPECT_TRUE(changed([](O& o) { o.nu_max = 0.81; }));
  EXPECT_TRUE(changed([](O& o) { o.nu_end = 0.71; }));
  EXPECT_TRUE(changed([](O& o) { o.gas_compression_factor = 5; }));
  EXPECT_TRUE(changed([](O& o) { o.keep_loading = {0.7}; }));
  EXPECT_TRUE(changed([](O& o) { o.keep_unloading = {0.75}; }));
  EXPECT_TRUE(changed([](O& o) { o.rows = 21; }));

  const auto key_of = [](const PreparationOptions& o, const Path& path) { return test_key({o, path, o.rows}); };
  PreparationOptions more = tiny();
  more.keep_unloading = {0.72, 0.74};  // another state kept on the way changes no test
  EXPECT_EQ(key_of(more, d2()), key_of(tiny(), d2()));
  EXPECT_NE(test_key({tiny(), d2(), 21}), key_of(tiny(), d2()));
  more = tiny();
  more.rows = 77;  // of the branches
  EXPECT_EQ(test_key({more, d2(), 20}), test_key({tiny(), d2(), 20}));
  PreparationOptions minimised = tiny();
  minimised.drive.quasi_static_step = more.drive.quasi_static_step = 1e-3;  // rows of the branches cut its steps
  EXPECT_NE(test_key({more, d2(), 20}), test_key({minimised, d2(), 20}));
  more = tiny();
  more.packing.seed = 5;
  EXPECT_NE(key_of(more, d2()), key_of(tiny(), d2()));
  EXPECT_NE(key_of(tiny(), d2(0.75)), key_of(tiny(), d2()));
  Path longer = d2();
  longer.segments[0].extent = 0.03;
  EXPECT_NE(key_of(tiny(), longer), key_of(tiny(), d2()));
}

TEST_F(Runs, AreExecutedOnceAndRepeatedWhenDamaged) {
  const RunStore store(folder_, "runs");
  const Json record = ensure_preparation(store, tiny(), {}, {});
  const std::string key = record.at("key");
  EXPECT_EQ(record.at("states").size(), 1u);
  const fs::path state = store.folder(key) / kept_file(Branch::unloading, 0.74);
  EXPECT_NEAR(volume_fraction(read_state(state).packing), 0.74, 1e-15);
  EXPECT_TRUE(fs::exists(store.folder(key) / "loading.csv"));

  const auto written = fs::last_write_time(store.folder(key) / "run.json");
  const std::string bytes = content(state);
  EXPECT_EQ(ensure_preparation(store, tiny(), {}, {}), record);
  EXPECT_EQ(fs::last_write_time(store.folder(key) / "run.json"), written);

  {  // what the system fails to read is not damaged
    const testing::NoDescriptors full;
    EXPECT_THROW(store.find(key), Error);
    EXPECT_THROW(ensure_preparation(store, tiny(), {}, {}), Error);
  }
  EXPECT_EQ(store.find(key), record);
  EXPECT_FALSE(fs::exists(store.folder(key + ".damaged")));

  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  put("runs/" + key + "/" + state.filename().string(), damaged);
  EXPECT_FALSE(store.find(key));
  ensure_preparation(store, tiny(), {}, {});
  EXPECT_EQ(content(state), bytes);  // the same bits again

  for (const char* change : {R"({"cost": 1})", R"({"cost": {"steps": -1}})", R"({"packing": {"mean_radius": null}})",
                             R"({"packing": {"particles": 1e300}})", R"({"warnings": [1]})", R"({"files": 3})"}) {
    Json record_changed = record;  // its files are sound, what it says is not
    record_changed.merge_patch(Json::parse(change));
    write_json(store.folder(key) / "run.json", OrderedJson(record_changed));
    EXPECT_FALSE(store.find(key)) << change;
  }
  fs::remove(store.folder(key) / "run.json");  // as if killed before the end
  put("runs/" + key + "/leftover", "x");
  EXPECT_FALSE(store.find(key));
  ensure_preparation(store, tiny(), {}, {});
  EXPECT_FALSE(fs::exists(store.folder(key) / "leftover"));
}

// A record that is JSON still, but not what was written.
TEST_F(Runs, PutADamagedRecordAsideAndRunAgain) {
  const RunStore store(folder_, "runs");
  const std::string key = ensure_preparation(store, tiny(), {}, {}).at("key");
  const fs::path file = store.folder(key) / "run.json";
  const Json sound = read_json(file, JsonSource::own);
  for (const char* lost : {"packing", "cost", "sha256", "format_version"}) {
    Json damaged = sound;
    damaged.erase(lost);
    put("runs/" + key + "/run.json", damaged.dump());
    EXPECT_FALSE(store.find(key)) << lost;
    std::string said;
    ResumePolicy policy;
    policy.log = [&](const std::string& line) { said += line; };
    const Json again = ensure_preparation(store, tiny(), policy, {});
    EXPECT_EQ(again.at("files"), sound.at("files")) << lost;
    EXPECT_NE(said.find(file.string() + ": damaged"), std::string::npos) << said;
    EXPECT_EQ(content(store.folder(key + ".damaged") / "run.json"), damaged.dump());
  }
}

TEST_F(Runs, TestStartsFromTheKeptStateWithAnyThreads) {
  const RunStore store(folder_, "runs");
  ensure_preparation(store, tiny(), {}, {});
  TestSetup test{tiny(), d2(), 20};
  const Json record = ensure_test(store, test, {}, {});
  const fs::path series = store.folder(record.at("key")) / "series.csv";
  const auto rows = read_series(series, d2(), packing_from_record(record));
  EXPECT_EQ(rows.size(), 21u);
  EXPECT_NEAR(rows.back().eps_dev, 0.02, 1e-15);
  EXPECT_GT(cost_from_record(record).steps, 0u);
  EXPECT_EQ(packing_from_record(record).particles, 32);
  EXPECT_GT(packing_from_record(record).mean_radius, 0.5e-3);

  const std::string bytes = content(series);
  fs::remove(store.folder(record.at("key")) / "run.json");
  test.preparation.engine.threads = 2;
  ensure_test(store, test, {}, {});
  EXPECT_EQ(content(series), bytes);
}

/// Stops the work soon after it has begun or continued a stage. Each stage reports its first step.
class Interruption {
 public:
  explicit Interruption(std::string stage) : stage_(std::move(stage)) {}
  RunControl control() {
    return {[this](const Progress& progress) {
              if (progress.stage == stage_) source_.request_stop();
            },
            source_.get_token()};
  }

 private:
  std::string stage_;
  std::stop_source source_;
};

std::map<std::string, std::string> results(const fs::path& run) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(run)) {
    const std::string name = entry.path().filename().string();
    if (name != "run.json") files[name] = sha256_of_file(entry.path());
  }
  return files;
}

// Hard cases R6, R10, R11: an interrupted run goes on from its checkpoint, or from the one before a damaged one, and ends
// as the uninterrupted one does. Damage to what it had yielded makes it start anew.
TEST_F(Runs, GoOnFromTheirCheckpoints) {
  fs::create_directory(folder_ / "whole");
  const RunStore whole(folder_ / "whole", "runs");
  const std::string key = ensure_preparation(whole, tiny(), {}, {}).at("key");
  const auto expected = results(whole.folder(key));
  ASSERT_EQ(expected.size(), 3u);

  const RunStore store(folder_, "runs");
  const fs::path run = store.folder(key);
  std::vector<std::string> log;
  ResumePolicy policy{true, 0, [&](const std::string& text) { log.push_back(text); }};
  const auto interrupt_twice = [&] {
    for (int i = 0; i < 2; ++i) {
      Interruption interruption("loading");
      policy.checkpoint_interval = 0;
      EXPECT_THROW(ensure_preparation(store, tiny(), policy, interruption.control()), Interrupted);
    }
    policy.checkpoint_interval = 60;
    ASSERT_TRUE(fs::exists(run / kCheckpoint));
    ASSERT_TRUE(fs::exists(run / kPreviousCheckpoint));
    log.clear();
  };
  const auto damage = [&](const std::string& name) {
    std::string bytes = content(run / name);
    bytes[bytes.size() / 2] ^= 4;
    put("runs/" + key + "/" + name, bytes);
  };

  interrupt_twice();
  {  // a checkpoint that the system fails to read is not thrown away
    const testing::NoDescriptors full;
    EXPECT_THROW(ensure_preparation(store, tiny(), policy, {}), Error);
  }
  EXPECT_TRUE(fs::exists(run / kCheckpoint) && fs::exists(run / kPreviousCheckpoint));
  EXPECT_TRUE(log.empty());
  EXPECT_EQ(ensure_preparation(store, tiny(), policy, {}).at("warnings"), whole.find(key)->at("warnings"));
  EXPECT_EQ(results(run), expected);
  ASSERT_EQ(log.size(), 1u);
  EXPECT_TRUE(log[0].starts_with("goes on from the checkpoint at step")) << log[0];

  fs::remove(run / "run.json");
  interrupt_twice();
  damage(kCheckpoint);
  ensure_preparation(store, tiny(), policy, {});
  EXPECT_EQ(results(run), expected);
  ASSERT_EQ(log.size(), 2u);
  EXPECT_NE(log[0].find("its checksum does not fit"), std::string::npos) << log[0];

  fs::remove(run / "run.json");
  interrupt_twice();
  damage(kCheckpoint);
  damage(kPreviousCheckpoint);
  ensure_preparation(store, tiny(), policy, {});
  EXPECT_EQ(results(run), expected);
  EXPECT_EQ(log.size(), 2u) << "two damaged files, nothing to go on from";

  fs::remove(run / "run.json");
  interrupt_twice();
  put("runs/" + key + "/" + kProgress, R"({"states": [], "warnings": [], "files": {"loading.csv": "0"}})");
  ensure_preparation(store, tiny(), policy, {});
  EXPECT_EQ(results(run), expected);
  EXPECT_NE(log.back().find("starts anew"), std::string::npos);

  fs::remove(run / "run.json");
  interrupt_twice();
  policy.resume = false;
  ensure_preparation(store, tiny(), policy, {});
  EXPECT_EQ(results(run), expected);
  EXPECT_TRUE(log.empty());
}

TEST_F(Runs, DoNotTakeTheCheckpointOfAnother) {
  const RunStore store(folder_, "runs");
  ensure_preparation(store, tiny(), {}, {});
  const auto interrupted = [&](const Path& path) {
    Interruption interruption("element test");
    const TestSetup test{tiny(), path, 20};
    EXPECT_THROW(ensure_test(store, test, {true, 0, {}}, interruption.control()), Interrupted);
    return store.folder(test_key(test)) / kCheckpoint;
  };
  Path longer = d2();
  longer.segments[0].extent = 0.03;
  fs::copy_file(interrupted(longer), interrupted(d2()), fs::copy_options::overwrite_existing);
  std::vector<std::string> log;
  ensure_test(store, {tiny(), d2(), 20}, {true, 0, [&](const std::string& text) { log.push_back(text); }}, {});
  ASSERT_FALSE(log.empty());
  EXPECT_NE(log[0].find("is of another run"), std::string::npos) << log[0];
}

dem::Spec tiny_spec() {
  Spec spec = spec_from_json(
      parse_json(
          R"({"particles": 32, "strain_rate": 20000, "rows": 20, "densities": [0.74], "nu_end": 0.70, "keep": [0.76],
      "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.02, "role": "calibration"}, {"mode": "UNI", "strain": 0.01, "role": "validation"}]})",
          "s.json", JsonSource::user),
      "s.json");
  return spec;
}

TEST_F(Runs, BecomeADataSet) {
  const Spec spec = tiny_spec();
  const auto planned = plan(spec);
  ASSERT_EQ(planned.size(), 6u);  // 3 tests on 2 packings
  Execution session{.threads = 2};
  const RunStore store(folder_, "runs");
  fs::create_directory(folder_ / "dataset");
  RunCounts counts;
  const Dataset first = run_planned(planned, Json(spec_to_json(spec)), folder_ / "dataset", store, session, counts);
  EXPECT_EQ(counts.runs, 6u);  // 2 preparations, 4 tests; ISO costs nothing
  EXPECT_EQ(counts.found, 0u);
  EXPECT_EQ(first.tests[0].record.name, "ISO-unloading-s1");
  EXPECT_EQ(first.tests[2].record.role, Role::validation);
  EXPECT_EQ(first.seeds, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(read_dataset(folder_ / "dataset").digest, first.digest);
  const TestRecord& iso = first.tests[0].record;
  EXPECT_NEAR(iso.rows.front().nu, 0.82, 1e-12);
  EXPECT_NEAR(iso.rows.back().nu, 0.70, 1e-12);

  // the same in another order of scheduling, then fewer tests: stale series go
  session.threads = 1;
  RunCounts again;
  const Dataset second = run_planned(planned, Json(spec_to_json(spec)), folder_ / "dataset", store, session, again);
  EXPECT_EQ(again.found, 6u);
  EXPECT_EQ(second.digest, first.digest);
  RunCounts fewer;
  run_planned({planned[0], planned[1]}, Json(spec_to_json(spec)), folder_ / "dataset", store, session, fewer);
  EXPECT_FALSE(fs::exists(folder_ / "dataset" / "D2-0.74-s2.csv"));
  EXPECT_EQ(read_dataset(folder_ / "dataset").tests.size(), 2u);
}

TEST_F(Runs, ProbesAreKeptBesideTheSeries) {
  const auto with_probes = [](const std::string& probes) {
    const std::string name = "s.json";
    return spec_from_json(
        parse_json(
            R"({"particles": 32, "strain_rate": 20000, "rows": 20, "densities": [0.74], "nu_end": 0.70, "seeds": [1],
      "tests": [{"mode": "D2", "strain": 0.02, "role": "calibration")" +
                probes + "}]}",
            name, JsonSource::user),
        name);
  };
  const Spec spec = with_probes(R"(, "probes": {"every": 0.01})");
  Execution session{.threads = 1};
  const RunStore store(folder_, "runs");
  const fs::path folder = folder_ / "dataset", probes = folder / kProbesFolder / "D2-0.74-s1.csv";
  fs::create_directory(folder);
  RunCounts counts;
  const Dataset made = run_planned(plan(spec), Json(spec_to_json(spec)), folder, store, session, counts);
  EXPECT_EQ(made.tests[0].probes_sha256, sha256_of_file(probes));
  const Dataset read = read_dataset(folder);
  EXPECT_EQ(read.tests[0].probes_sha256, made.tests[0].probes_sha256);
  EXPECT_EQ(spec_to_json(spec_from_json(read.spec, "d.json")), spec_to_json(spec));

  const std::string bytes = content(probes);
  std::ofstream(probes, std::ios::binary) << bytes << "1";
  EXPECT_NE(refusal([&] { read_dataset(folder); }).find("probes/D2-0.74-s1.csv: is not the file"), std::string::npos);

  // without probes: another run, the same series, and no stale probes
  const Spec plain = with_probes("");
  const Dataset without = run_planned(plan(plain), Json(spec_to_json(plain)), folder, store, session, counts);
  EXPECT_NE(without.tests[0].run, made.tests[0].run);
  EXPECT_EQ(without.tests[0].sha256, made.tests[0].sha256);
  EXPECT_NE(without.digest, made.digest);
  EXPECT_FALSE(fs::exists(probes));
}

TEST_F(Runs, OfPredictionsUseNewPackings) {
  using Seeds = std::vector<std::uint64_t>;
  const Spec spec = tiny_spec();
  PathFile path{d2(0.75), {}, {}};
  const auto seeds = [&](Seeds wished, Seeds fitted) { return new_seeds(spec, path, wished, fitted, "p.json"); };
  const auto said = [&](Seeds wished, Seeds fitted) { return refusal([&] { seeds(wished, fitted); }); };
  EXPECT_EQ(seeds({}, {}), (Seeds{3, 4}));
  EXPECT_EQ(seeds({}, {5, 7}), (Seeds{8, 9})) << "fitted by another spec";
  path.seeds = {11};
  EXPECT_EQ(seeds({}, {}), Seeds{11});
  EXPECT_EQ(seeds({12, 13}, {}), (Seeds{12, 13}));
  EXPECT_TRUE(said({5, 2}, {}).starts_with("p.json: seeds: 2 was used for the calibration"));
  EXPECT_TRUE(said({5, 7}, {7}).starts_with("p.json: seeds: 7 was used for the calibration"));
  EXPECT_NE(said({5, 5}, {}).find("given twice"), std::string::npos);

  const auto tests = plan(spec, path, {11, 12}, "p.json");
  ASSERT_EQ(tests.size(), 2u);
  EXPECT_EQ(tests[0].name, "D2-0.75-s11");
  EXPECT_EQ(tests[0].role, Role::validation);
  EXPECT_EQ(tests[0].preparation.keep_unloading, (std::vector<double>{0.75, 0.76}));
  // paths that start at densities of `keep` share their preparations
  const auto a = plan(spec, {d2(0.76), {}, {}}, {11}, "p.json");
  EXPECT_EQ(a[0].preparation.keep_unloading, std::vector<double>{0.76});
  const auto denser = plan(spec, {d2(0.76), {}, 50}, {11}, "p.json");  // other rows, the same packing
  EXPECT_EQ(denser[0].rows, 50);
  EXPECT_EQ(preparation_key(denser[0].preparation), preparation_key(a[0].preparation));
  const std::string off = refusal([&] { plan(spec, {d2(0.69), {}, {}}, {11}, "p.json"); });
  EXPECT_NE(off.find("0.69 is not on the unloading branch"), std::string::npos) << off;
}

}  // namespace
}  // namespace grainlaw::dem
