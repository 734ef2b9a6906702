// R5, R10, R11: a run continued from a checkpoint is the uninterrupted run, bit for bit; a damaged one is refused.

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dem/element_tests/preparation.hpp"
#include "dem/element_tests/stepper.hpp"
#include "dem/files/state_file.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

using grainlaw::testing::expect_figure;
using grainlaw::testing::refusal;

/// A packing in contact, moving, and a path with a corner: shear, then compression, in some hundred steps.
struct Scene {
  State start;
  std::vector<StraightSegment> path;
  ElementTestOptions options;

  explicit Scene(Transport transport, Profile profile) {
    options.engine = scene::engine_options();
    scene::Draw draw(5);
    start = scene::random_state(60, 3, 0.75, scene::cubic(1), draw);
    relax(start, {}, {}, {});
    scale_to_volume_fraction(start.packing, 0.75);
    path = resolve({0.75,
                    Branch::unloading,
                    {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, 0.03},
                     {Mode::ISO, direction_of(Mode::ISO, "xyz", false), ExtentKind::target_nu, 0.76}}});
    options.drive.strain_rate = 10000;
    options.drive.transport = transport;
    options.drive.profile = profile;
    options.engine.skin = 0.01;  // a list that is rebuilt often
    options.rows = 15;
    options.stop_energy_residual = 1;  // walls that pump energy into few spheres are not the matter here
  }
};

class Restart : public grainlaw::testing::TemporaryFolder {
 protected:
  Restart() {
    // thousands of files that are synced one by one: where memory can be written to, there
    if (std::filesystem::is_directory("/dev/shm")) {
      std::filesystem::remove_all(folder_);
      folder_ = std::filesystem::path("/dev/shm") / folder_.filename();
      std::filesystem::create_directory(folder_);
    }
  }

  /// Everything that a run yields, as bytes.
  std::string bytes_of(const std::vector<Observation>& rows, const State& end) const {
    Checkpoint all;
    all.rows = rows;
    all.state = end;
    write_checkpoint(folder_ / "bytes", all);
    return content(folder_ / "bytes");
  }
  Checkpoint through_a_file(const Checkpoint& checkpoint) const {
    write_checkpoint(folder_ / "checkpoint", checkpoint);
    return read_checkpoint(folder_ / "checkpoint");
  }
};

// Each step of the whole path is a restart point: more than 100 consecutive ones, in contact, at rebuilds of the list,
// around the corner, amid the deformation.
TEST_F(Restart, R5EveryStepContinuesToTheSameBits) {
  int points = 0, differing = 0, rebuilds = 0;
  for (const Transport transport : {Transport::homogeneous, Transport::wall}) {
    for (const Profile profile : {Profile::cosine, Profile::constant}) {
      const Scene scene(transport, profile);
      std::vector<Checkpoint> all;
      Eigen::Matrix3d reference = Eigen::Matrix3d::Zero();
      const Checkpointing every_step{[&](const Checkpoint& c) {
                                       all.push_back(c);
                                       rebuilds += c.state.ref_H != reference ? 1 : 0;
                                       reference = c.state.ref_H;
                                     },
                                     0};
      const ElementTest whole = run_element_test(scene.start, scene.path, scene.options, {}, {}, every_step);
      ASSERT_EQ(all.size(), whole.steps);
      ASSERT_EQ(whole.rows.back().segment, 1);
      const std::string expected = bytes_of(whole.rows, whole.end);
      for (const Checkpoint& checkpoint : all) {
        const ElementTest rest = continue_element_test(through_a_file(checkpoint), scene.path, scene.options, {});
        ++points;
        differing += bytes_of(rest.rows, rest.end) == expected && rest.steps == whole.steps &&
                             rest.time_step == whole.time_step && rest.warnings == whole.warnings
                         ? 0
                         : 1;
      }
    }
  }
  EXPECT_GT(points, 400);
  EXPECT_GT(rebuilds, 20);
  fmt::print("count R5.restart_points {}\n", points);
  expect_figure("R5.differing_restarts", differing, 0);
}

// The list of a continued run is that of the cell and the positions at its last rebuild, not one of the moment: else a
// contact that closes later could be missing.
TEST_F(Restart, R5TheListIsTheInterruptedRuns) {
  Scene scene(Transport::homogeneous, Profile::constant);
  scene.options.engine.skin = 0.5;  // a list that lasts
  scene.path = resolve(
      {0.75, Branch::unloading, {{Mode::ISO, direction_of(Mode::ISO, "xyz", true), ExtentKind::target_nu, 0.70}}});
  int lists = 0, differing = 0;
  double largest_stretch = 0;
  const StepObserver compare = [&](Stepper& stepper, int, double) {
    Simulation& sim = stepper.simulation();
    CellMotion still;
    still.H = sim.state().packing.H;
    const NeighbourList list = scene::list_of(sim),
                        again = scene::list_of(Simulation(sim.state(), sim.options(), still));
    ++lists;
    const bool same = again.first == list.first && again.j == list.j && again.image == list.image;
    differing += same ? 0 : 1;
    largest_stretch = std::max(largest_stretch, sim.state().packing.H(0, 0) / sim.state().ref_H(0, 0) - 1);
  };
  run_element_test(scene.start, scene.path, scene.options, {}, compare);
  EXPECT_GT(lists, 100);
  EXPECT_GT(largest_stretch, 0.005);
  expect_figure("R5.differing_lists", differing, 0);
}

// R10: a stop saves before it throws; many stops in a row lose nothing.
TEST_F(Restart, R10AStoppedRunHasSavedItsLastStep) {
  const Scene scene(Transport::homogeneous, Profile::cosine);
  const ElementTest whole = run_element_test(scene.start, scene.path, scene.options, {});
  std::optional<Checkpoint> saved;
  const Checkpointing only_when_stopped{[&](const Checkpoint& c) { saved = c; }, 1e9};
  std::uint64_t steps = 0;
  for (;;) {
    std::stop_source source;
    std::uint64_t seen = 0;
    const StepObserver stop_at_the_seventh = [&](Stepper& stepper, int, double) {
      Simulation& sim = stepper.simulation();
      steps = sim.step();
      if (++seen == 7) source.request_stop();
    };
    const RunControl control{{}, source.get_token()};
    try {
      const ElementTest test = saved ? continue_element_test(*saved, scene.path, scene.options, control,
                                                             stop_at_the_seventh, only_when_stopped)
                                     : run_element_test(scene.start, scene.path, scene.options, control,
                                                        stop_at_the_seventh, only_when_stopped);
      expect_figure("R10.differing_bytes", bytes_of(test.rows, test.end) == bytes_of(whole.rows, whole.end) ? 0 : 1, 0);
      return;
    } catch (const Interrupted&) {
      ASSERT_TRUE(saved);
      ASSERT_EQ(saved->state.step, steps);
    }
  }
}

/// What the sink of a preparation gets, and gets only once.
struct Yield {
  std::map<std::pair<Branch, double>, State> kept;
  std::map<Branch, std::vector<Observation>> series;
  std::set<std::string> warnings;

  PreparationSink sink() {
    PreparationSink s;
    s.keep = [this](const KeptState& k) {
      EXPECT_FALSE(kept.contains({k.branch, k.nu})) << k.nu << " is made twice";
      kept[{k.branch, k.nu}] = k.state;
    };
    s.series = [this](Branch branch, const std::vector<Observation>& rows) { series[branch] = rows; };
    s.warn = [this](const std::string& text) { warnings.insert(text); };
    s.has = [this](Branch branch, double nu) { return kept.contains({branch, nu}); };
    return s;
  }
};

TEST_F(Restart, R5APreparationContinuesFromAllItsStages) {
  PreparationOptions options;
  options.packing.particles = 50;
  options.drive.strain_rate = 10000;
  options.gas_compression_factor = 2;
  options.nu_max = 0.75;
  options.keep_loading = {0.70, 0.75};
  options.keep_unloading = {0.74, 0.72};
  options.rows = 10;
  struct Moment {
    Checkpoint checkpoint;
    Yield yield;  // what had been delivered by then
  };
  std::vector<Moment> moments;
  Yield whole;
  std::uint64_t count = 0;
  const Checkpointing now_and_then{[&](const Checkpoint& c) {
                                     if (count++ % 23 == 0) moments.push_back({through_a_file(c), whole});
                                   },
                                   0};
  prepare(options, whole.sink(), {}, now_and_then);
  std::set<std::string> stages;
  for (Moment& moment : moments) {
    stages.insert(moment.checkpoint.stage);
    continue_preparation(moment.checkpoint, options, moment.yield.sink(), {});
    ASSERT_EQ(moment.yield.kept.size(), whole.kept.size());
    for (const auto& [key, state] : whole.kept) EXPECT_EQ(bytes_of({}, moment.yield.kept.at(key)), bytes_of({}, state));
    for (const auto& [branch, rows] : whole.series) {
      EXPECT_EQ(bytes_of(moment.yield.series.at(branch), {}), bytes_of(rows, {}));
    }
    EXPECT_EQ(moment.yield.warnings, whole.warnings);
  }
  EXPECT_EQ(stages, (std::set<std::string>{"gas compression", "loading", "unloading"}));
  EXPECT_GT(moments.size(), 20u);
}

/// A sound checkpoint of a short run.
Checkpoint some_checkpoint(const Scene& scene) {
  std::optional<Checkpoint> last;
  run_element_test(scene.start, scene.path, scene.options, {}, {}, {[&](const Checkpoint& c) { last = c; }, 0});
  return *last;
}

TEST_F(Restart, R11ADamagedCheckpointIsRefused) {
  const Scene scene(Transport::homogeneous, Profile::cosine);
  const auto file = folder_ / "checkpoint";
  write_checkpoint(file, some_checkpoint(scene));
  const std::string sound = content(file);
  const auto refused = [&](const std::string& bytes) {
    put("checkpoint", bytes);
    return refusal([&] { read_checkpoint(file); }).starts_with(file.string());
  };
  int accepted = 0, damages = 0;
  for (std::size_t i = 0; i < sound.size(); i += 1 + sound.size() / 500) {
    std::string flipped = sound;
    flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 8)));
    accepted += refused(flipped) ? 0 : 1;
    accepted += refused(sound.substr(0, i)) ? 0 : 1;
    damages += 2;
  }
  accepted += refused(sound + "x") ? 0 : 1;
  EXPECT_GT(damages, 900);
  expect_figure("R11.damaged_accepted", accepted, 0);
  put("checkpoint", sound);
  EXPECT_NO_THROW(read_checkpoint(file));
  write_state(file, scene.start);  // whole, but another format
  EXPECT_NE(refusal([&] { read_checkpoint(file); }).find("is not a checkpoint"), std::string::npos);
}

TEST_F(Restart, ACheckpointOfAnotherTestIsRefused) {
  const Scene scene(Transport::homogeneous, Profile::cosine);
  const Checkpoint sound = some_checkpoint(scene);
  const auto refuses = [&](const std::function<void(Checkpoint&)>& change) {
    Checkpoint changed = sound;
    change(changed);
    return refusal([&] { continue_element_test(changed, scene.path, scene.options, {}); }) != "accepted";
  };
  EXPECT_FALSE(refuses([](Checkpoint&) {}));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.segment = 2; }));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.segment = -1; }));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.segment_steps = 0; }));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.segment_steps = c.steps = 1000000; }));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.rows.clear(); }));
  EXPECT_TRUE(refuses([](Checkpoint& c) { c.state.ax.clear(); }));
  Checkpoint stranger = sound;
  stranger.stage = "elsewhere";
  Yield yield;
  EXPECT_NE(refusal([&] { continue_preparation(stranger, {}, yield.sink(), {}); }), "accepted");
}

}  // namespace
}  // namespace grainlaw::dem
