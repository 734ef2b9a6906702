#include "dem/element_tests/stepper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/element_tests/preparation.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

struct AffineScene {
  State start;
  std::vector<StraightSegment> path;
  ElementTestOptions options;

  AffineScene(double eps_dev, double step, int rows) {
    scene::Draw draw(5);
    start = scene::random_state(80, 3, 0.76, scene::cubic(1), draw);
    path = resolve({volume_fraction(start.packing),
                    Branch::unloading,
                    {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, eps_dev}}});
    options.engine = scene::engine_options();
    options.drive.quasi_static_step = step;
    options.relax.tolerance = 1e-9;
    options.rows = rows;
  }
  ElementTest run(const StepObserver& on_step = {}, const Checkpointing& checkpointing = {}) const {
    return run_element_test(start, path, options, {}, on_step, checkpointing);
  }
};

double max_net_force(const State& state) {
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  double largest = 0;
  for (const Eigen::Vector3d& f : sums.force) largest = std::max(largest, f.norm());
  return largest;
}

TEST(QuasiStatic, EveryStepEndsInEquilibriumOnThePath) {
  const AffineScene scene(0.06, 4e-3, 5);
  std::uint64_t seen = 0;
  const ElementTest test = scene.run([&](Stepper& stepper, int index, double e) {
    Simulation& sim = stepper.simulation();
    ++seen;
    EXPECT_EQ(index, 0);
    EXPECT_NEAR(e, scene.path[0].length * static_cast<double>(seen) / 15, 1e-15);
    EXPECT_LE(max_net_force(sim.state()), 1e-7 * sim.state().material.stiffness * mean_radius(sim.state().packing));
  });
  EXPECT_EQ(seen, 15u) << "three steps of 4e-3 for every row of 1.2e-2";
  ASSERT_EQ(test.rows.size(), 6u);
  for (std::size_t k = 0; k < test.rows.size(); ++k) {
    const Observation& row = test.rows[k];
    EXPECT_NEAR(row.eps_dev, 0.06 * static_cast<double>(k) / 5, 1e-15);
    EXPECT_NEAR(row.nu / test.rows[0].nu, 1, 1e-13);
    EXPECT_EQ(row.E_kin, 0);
    EXPECT_EQ(row.inertial_number, 0);
    if (k > 0) {
      EXPECT_GT(row.time, test.rows[k - 1].time);
    }
  }
  EXPECT_GT(test.rows.back().s_par, 0.02);
  EXPECT_GT(test.steps, 15u) << "steps are force passes";
  EXPECT_EQ(test.time_step, 0);
  EXPECT_TRUE(test.warnings.empty());
}

// dW = -V sigma : d eps, and without rearrangement the minimisations take less and less: D is of the order of the step.
TEST(QuasiStatic, WorkIsThatOfTheStressAndDissipationVanishesWithTheStep) {
  double dissipated[2];
  for (const int k : {0, 1}) {
    AffineScene scene(4e-5, k == 0 ? 4e-6 : 2e-6, 10);
    scene.options.relax.tolerance = 1e-12;
    const ElementTest test = scene.run();
    double work = 0;
    for (std::size_t i = 1; i < test.rows.size(); ++i) {
      const Eigen::Matrix3d sigma = (test.rows[i - 1].stress.tensor + test.rows[i].stress.tensor) / 2;
      work -=
          test.end.packing.volume() * (sigma * (test.rows[i].strain.tensor - test.rows[i - 1].strain.tensor)).trace();
    }
    const Observation& last = test.rows.back();
    EXPECT_NEAR((last.E_pot - test.rows[0].E_pot) / work, 1, 1e-3);
    EXPECT_NEAR(last.W_box - last.D_contact, last.E_pot - test.rows[0].E_pot, 1e-9 * test.rows[0].E_pot);
    dissipated[k] = last.D_contact;
  }
  EXPECT_GT(dissipated[0], 0);
  EXPECT_NEAR(dissipated[0] / dissipated[1], 2, 0.05);
}

// A simple cubic lattice stays one: the minimisation has nothing to do.
TEST(QuasiStatic, ALatticeIsCompressedAffinely) {
  std::vector<scene::Sphere> balls;
  for (int i = 0; i < 64; ++i) {
    const Eigen::Vector3d place(i % 4, i / 4 % 4, i / 16);
    balls.push_back({1e-3, 1.9e-3 * (place + Eigen::Vector3d::Constant(0.5)), {0, 0, 0}});
  }
  AffineScene scene(0.01, 1e-3, 4);
  scene.start = scene::state_of(scene::cubic(4 * 1.9e-3), balls);
  scene.path = resolve({volume_fraction(scene.start.packing),
                        Branch::loading,
                        {{Mode::ISO, direction_of(Mode::ISO, "xyz", false), ExtentKind::eps_vol, 0.03}}});
  const ElementTest test = scene.run();
  for (const Observation& row : test.rows) {
    const double d = 1.9e-3 * std::exp(row.eps_vol / 3), k = scene.start.material.stiffness;
    EXPECT_NEAR(row.stress.tensor(0, 0) / (k * (2e-3 - d) / (d * d)), 1, 1e-9);  // one bond on each d^2
    EXPECT_NEAR(row.D_contact, 0, 1e-12 * row.E_pot);
    EXPECT_NEAR(row.E_pot / (64 * 3 * k * (2e-3 - d) * (2e-3 - d) / 2), 1, 1e-9);
  }
}

// R5: from each checkpoint the same run, bit for bit.
TEST(QuasiStatic, ContinuesToTheSameBits) {
  AffineScene scene(0.02, 2e-3, 5);
  scene.path = resolve({volume_fraction(scene.start.packing),
                        Branch::unloading,
                        {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, 0.02},
                         {Mode::ISO, direction_of(Mode::ISO, "xyz", false), ExtentKind::eps_vol, 0.01}}});
  std::vector<Checkpoint> all;
  const ElementTest whole = scene.run({}, {[&](const Checkpoint& c) { all.push_back(c); }, 0});
  ASSERT_EQ(all.size(), 15u);
  for (const Checkpoint& checkpoint : all) {
    const ElementTest rest = continue_element_test(checkpoint, scene.path, scene.options, {});
    EXPECT_EQ(rest.end.packing.sx, whole.end.packing.sx);
    EXPECT_EQ(rest.end.ledger.W_box, whole.end.ledger.W_box);
    EXPECT_EQ(rest.steps, whole.steps);
    ASSERT_EQ(rest.rows.size(), whole.rows.size());
    EXPECT_EQ(rest.rows.back().P_star, whole.rows.back().P_star);
    EXPECT_EQ(rest.rows.back().shear_path, whole.rows.back().shear_path);
    EXPECT_EQ(rest.rows.back().time, whole.rows.back().time);
  }
}

TEST(QuasiStatic, StopsOnRequestAtAStep) {
  const AffineScene scene(0.05, 1e-3, 10);
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::vector<Checkpoint> saved;
  std::uint64_t steps = 0;
  EXPECT_THROW(run_element_test(scene.start, scene.path, scene.options, control,
                                [&](Stepper&, int, double) {
                                  if (++steps == 7) stop.request_stop();
                                },
                                {[&](const Checkpoint& c) { saved.push_back(c); }, 3600}),
               Interrupted);
  ASSERT_EQ(saved.size(), 1u);
  EXPECT_EQ(saved[0].segment_steps, 7u);
  const ElementTest rest = continue_element_test(saved[0], scene.path, scene.options, {});
  EXPECT_EQ(rest.end.packing.sx, scene.run().end.packing.sx);
}

TEST(QuasiStatic, SaysWhereMinimisationsStoppedShort) {
  AffineScene scene(0.01, 2e-3, 5);
  relax(scene.start, {}, {1e-10, 200000}, {});
  scene.options.relax.max_passes = 3;
  const ElementTest test = scene.run();
  ASSERT_EQ(test.warnings.size(), 1u);
  EXPECT_TRUE(test.warnings[0].starts_with("5 minimisations stopped short")) << test.warnings[0];
}

TEST(QuasiStatic, RefusesWhatItCannotDo) {
  AffineScene scene(0.01, 2e-3, 5);
  scene.options.drive.transport = Transport::wall;
  EXPECT_THROW(check(EngineChoice{}, scene.options.engine, scene.options.drive), InvalidInput);
  scene.options.drive.transport = Transport::homogeneous;
  scene.options.drive.quasi_static_step = 1e-14;
  EXPECT_THROW(scene.run(), InvalidInput);
}

// The branches of a preparation as well; the gas is compressed with dynamics.
TEST(QuasiStatic, APreparationKeepsStatesAtTheirDensities) {
  PreparationOptions options;
  options.packing.particles = 100;
  options.nu_max = 0.72;
  options.keep_unloading = {0.70};
  options.nu_end = 0.69;
  options.rows = 10;
  options.drive.strain_rate = 3000;
  options.drive.quasi_static_step = 5e-3;
  int kept = 0, branches = 0;
  PreparationSink sink;
  sink.keep = [&](const KeptState& state) {
    ++kept;
    EXPECT_NEAR(volume_fraction(state.state.packing), 0.70, 1e-12);
    EXPECT_TRUE(state.relaxation.relaxed);
  };
  sink.series = [&](Branch, const std::vector<Observation>& rows) {
    ++branches;
    ASSERT_EQ(rows.size(), 11u);
    for (const Observation& row : rows) EXPECT_EQ(row.E_kin, 0);
  };
  prepare(options, sink, {});
  EXPECT_EQ(kept, 1);
  EXPECT_EQ(branches, 2);
}

}  // namespace
}  // namespace grainlaw::dem
