#include "dem/element_tests/element_run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "dem/element_tests/energy_watch.hpp"
#include "dem/element_tests/stepper.hpp"
#include "dem/files/state_file.hpp"
#include "dem/statics/relax.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

/// A relaxed packing of n spheres.
State relaxed_packing(std::size_t n, double nu) {
  scene::Draw draw(n);
  State state = scene::random_state(n, 3, nu, scene::cubic(1), draw);
  relax(state, {}, {}, {});
  scale_to_volume_fraction(state.packing, nu);
  return state;
}

PathSegment segment(Mode mode, ExtentKind kind, double extent, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), kind, extent};
}

std::vector<StraightSegment> path_of(const State& state, const std::vector<PathSegment>& segments) {
  return resolve({volume_fraction(state.packing), Branch::unloading, segments});
}

/// Fast enough for a unit test: 5 % of strain in some thousand steps.
ElementTestOptions fast_options(int rows = 20) {
  ElementTestOptions options;
  options.engine = scene::engine_options();
  options.drive.strain_rate = 3000;
  options.rows = rows;
  return options;
}

TEST(ElementTest, D2KeepsTheVolumeAndFollowsItsPath) {
  const State start = relaxed_packing(60, 0.75);
  const auto path = path_of(start, {segment(Mode::D2, ExtentKind::eps_dev, 0.1)});
  const ElementTest test = run_element_test(start, path, fast_options(), {});
  ASSERT_EQ(test.rows.size(), 21u);
  const double length = 0.1 / std::sqrt(3.0);
  for (std::size_t k = 0; k < test.rows.size(); ++k) {
    const Observation& row = test.rows[k];
    const double e = -row.strain.tensor(2, 2);
    EXPECT_NEAR(row.nu / 0.75, 1, 1e-13);
    EXPECT_NEAR(row.eps_vol, 0, 1e-16);
    EXPECT_EQ(row.strain.tensor(0, 0), e);
    EXPECT_EQ(row.strain.tensor(1, 1), 0);
    EXPECT_NEAR(row.eps_dev, std::sqrt(3.0) * e, 1e-15);
    EXPECT_NEAR(row.shear_path, row.eps_dev, 1e-15);
    EXPECT_GE(e, length * static_cast<double>(k) / 20 * (1 - 1e-15));
    EXPECT_LT(e, length * (static_cast<double>(k) / 20 + 0.01));
    if (k > 0) {
      EXPECT_GT(row.time, test.rows[k - 1].time);
      EXPECT_NEAR(row.lode_strain, 30, 1e-6);
    }
  }
  const Eigen::Matrix3d stretch = test.end.packing.H * start.packing.H.inverse();
  EXPECT_NEAR(stretch(0, 0), std::exp(length), 1e-13);
  EXPECT_NEAR(stretch(2, 2), std::exp(-length), 1e-13);
  EXPECT_GT(test.rows.back().s_par, 0.02) << "shear must build a stress ratio along its direction";
}

TEST(ElementTest, CornersAddStrainAndCountSegments) {
  const State start = relaxed_packing(60, 0.72);
  const auto path =
      path_of(start, {segment(Mode::D2, ExtentKind::eps_dev, 0.06), segment(Mode::ISO, ExtentKind::target_nu, 0.74),
                      segment(Mode::ISO, ExtentKind::target_nu, 0.72, true),
                      segment(Mode::D2, ExtentKind::eps_dev, 0.06, true)});
  for (const Profile profile : {Profile::cosine, Profile::constant}) {
    ElementTestOptions options = fast_options(8);
    options.drive.profile = profile;
    const ElementTest test = run_element_test(start, path, options, {});
    ASSERT_EQ(test.rows.size(), 1u + 4 * 8u);
    EXPECT_NEAR(test.rows[8].eps_dev, 0.06, 1e-15);
    EXPECT_EQ(test.rows[8].segment, 0);
    EXPECT_EQ(test.rows[9].segment, 1);
    EXPECT_NEAR(test.rows[16].nu, 0.74, 1e-13);
    EXPECT_NEAR(test.rows[16].eps_vol, std::log(0.72 / 0.74), 1e-14);
    EXPECT_NEAR(test.rows[24].nu, 0.72, 1e-13);
    EXPECT_NEAR(test.rows[24].eps_dev, 0.06, 1e-15);
    EXPECT_NEAR(test.rows[24].shear_path, 0.06, 1e-15);
    const Observation& last = test.rows.back();
    EXPECT_EQ(last.segment, 3);
    EXPECT_NEAR(last.eps_dev, 0, 1e-15);
    EXPECT_NEAR(last.shear_path, 0.12, 1e-15);
    EXPECT_TRUE(std::isnan(last.lode_strain)) << "rounding has no direction";
    EXPECT_EQ(last.time, test.end.time);
    EXPECT_EQ(test.end.step, test.steps);
  }
}

// Where the rate jumps, so do the viscous forces: a run takes a corner as a run does that begins there.
TEST(ElementTest, AfterACornerForcesAreThoseOfTheNewRate) {
  const State start = relaxed_packing(60, 0.75);
  const auto path = path_of(
      start, {segment(Mode::D2, ExtentKind::eps_dev, 0.02), segment(Mode::D2, ExtentKind::eps_dev, 0.02, true)});
  ElementTestOptions options = fast_options(2);
  options.drive.profile = Profile::constant;
  const auto first_step_of = [](int segment, std::vector<double>& v) {
    return [&v, segment](Stepper& stepper, int index, double) {
      if (index == segment && v.empty()) v = stepper.simulation().state().packing.vx;
    };
  };
  std::vector<double> v, v_begun;
  run_element_test(start, path, options, {}, first_step_of(1, v));
  const State corner = run_element_test(start, {path[0]}, options, {}).end;
  run_element_test(corner, {path[1]}, options, {}, first_step_of(0, v_begun));
  ASSERT_EQ(v.size(), start.packing.vx.size());
  ASSERT_EQ(v_begun.size(), v.size());
  const double largest = std::abs(*std::ranges::max_element(v, {}, [](double x) { return std::abs(x); }));
  ASSERT_GT(largest, 0);
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_NEAR(v[i], v_begun[i], 1e-12 * largest) << i;
}

TEST(ElementTest, TheClockAndTheLedgerBeginAtZero) {
  State start = relaxed_packing(40, 0.75);
  start.time = 7;
  start.step = 9;
  start.ledger.W_box = 3;
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.02)});
  const ElementTest test = run_element_test(start, path, fast_options(), {});
  EXPECT_EQ(test.rows.front().time, 0);
  EXPECT_EQ(test.rows.front().W_box, 0);
  EXPECT_EQ(test.rows.front().energy_residual, 0);
  // compression at pressure P: the box does about P dV of work
  const Observation& last = test.rows.back();
  EXPECT_GT(last.W_box, 0);
  const double balance =
      last.W_box - (last.E_pot + last.E_kin - test.rows.front().E_pot) - last.D_contact - last.D_background;
  EXPECT_LE(std::abs(balance), 1e-3 * last.W_box);
  EXPECT_NEAR(last.energy_residual, balance / (last.W_box + last.D_contact + last.D_background), 1e-12);
}

TEST(ElementTest, ATimeStepIsAtMostTheEnginesAndSegmentsEndExactly) {
  const State start = relaxed_packing(20, 0.75);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.01)});
  std::uint64_t seen = 0;
  double last_e = 0;
  const ElementTestOptions options = fast_options();
  const ElementTest test = run_element_test(start, path, options, {}, [&](Stepper& stepper, int index, double e) {
    Simulation& sim = stepper.simulation();
    ++seen;
    EXPECT_EQ(sim.step(), seen);
    EXPECT_EQ(index, 0);
    EXPECT_GT(e, last_e);
    last_e = e;
  });
  EXPECT_EQ(seen, test.steps);
  EXPECT_EQ(last_e, path[0].length);
  const double engine_dt = 0.1 * min_collision_time(start.packing, start.material);
  EXPECT_LE(test.time_step, engine_dt * (1 + 1e-9));
  EXPECT_GT(test.time_step, 0.99 * engine_dt);
  const double duration = make_drive(path[0], options.drive, start.packing.H).duration;
  EXPECT_NEAR(test.time_step * static_cast<double>(test.steps), duration, 1e-12 * duration);
}

TEST(ElementTest, WithoutStepsForEveryRowItRecordsWhatThereIs) {
  const State start = relaxed_packing(10, 0.7);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 3e-3)});
  const ElementTest test = run_element_test(start, path, fast_options(100000), {});
  EXPECT_GE(test.steps, 1u);
  EXPECT_EQ(test.rows.size(), test.steps + 1);
  EXPECT_EQ(test.rows.back().eps_vol, -path[0].length);
}

TEST(ElementTest, AnEmptyPathIsTheStateItself) {
  const State start = relaxed_packing(20, 0.75);
  const ElementTest test = run_element_test(start, {}, fast_options(), {});
  ASSERT_EQ(test.rows.size(), 1u);
  EXPECT_EQ(test.rows[0].eps_dev, 0);
  EXPECT_EQ(test.steps, 0u);
  EXPECT_GT(test.rows[0].P_star, 0);
}

// Hard case D21: one sphere without contact has no pressure, and what is divided by it is undefined.
TEST(ElementTest, OneSphereHasNoPressure) {
  const State start = scene::state_of(scene::cubic(4e-3), {{1e-3, {1e-3, 1e-3, 1e-3}, {0, 0, 0}}});
  const auto path = path_of(start, {segment(Mode::D3, ExtentKind::eps_dev, 0.1)});
  const ElementTest test = run_element_test(start, path, fast_options(), {});
  for (const Observation& row : test.rows) {
    EXPECT_EQ(row.P_star, 0);
    EXPECT_TRUE(std::isnan(row.s_dev) && std::isnan(row.s_par) && std::isnan(row.C_star) &&
                std::isnan(row.inertial_number));
    EXPECT_EQ(row.energy_residual, 0);
  }
}

TEST(ElementTest, WallsMoveTheEdgesToTheSameCell) {
  const State start = relaxed_packing(60, 0.75);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::target_nu, 0.76)});
  ElementTestOptions options = fast_options();
  options.drive.strain_rate = 500;
  const ElementTest homogeneous = run_element_test(start, path, options, {});
  options.drive.transport = Transport::wall;
  const ElementTest wall = run_element_test(start, path, options, {});
  EXPECT_EQ(wall.end.packing.H, homogeneous.end.packing.H);
  EXPECT_NE(wall.end.packing.sx, homogeneous.end.packing.sx);
  EXPECT_NEAR(wall.rows.back().P_star / homogeneous.rows.back().P_star, 1, 0.1);
  EXPECT_LT(std::abs(wall.rows.back().energy_residual), 1e-2);
}

TEST(ElementTest, RefusesATimeStepBeyondStability) {
  const State start = relaxed_packing(20, 0.75);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.01)});
  ElementTestOptions options = fast_options();
  for (const double fraction : {0.41, 0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    options.engine.time_step_fraction = fraction;
    try {
      run_element_test(start, path, options, {});
      ADD_FAILURE() << fraction << " was accepted";
    } catch (const InvalidInput& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("time_step_fraction")) << error.what();
    }
  }
}

// Hard case D16: past stability the run goes quietly wrong; the energy balance must stop it.
TEST(ElementTest, TheEnergyBalanceStopsAnUnstableRun) {
  const State start = relaxed_packing(100, 0.78);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.02)});
  ElementTestOptions options = fast_options();
  options.engine.time_step_fraction = 1 / 1.5;
  options.check_time_step = false;
  try {
    run_element_test(start, path, options, {});
    FAIL() << "an unstable run ended green";
  } catch (const InvalidInput& error) {
    FAIL() << error.what();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("energy balance"), std::string::npos) << error.what();
  }
}

TEST(ElementTest, TheLargestEnergyResidualIsTheOneThatJustStopsIt) {
  const State start = relaxed_packing(60, 0.74);
  const auto path = path_of(start, {segment(Mode::D2, ExtentKind::eps_dev, 0.02)});
  ElementTestOptions options = fast_options();
  const double largest = largest_energy_residual(run_element_test(start, path, options, {}).rows);
  EXPECT_GT(largest, 0);
  options.stop_energy_residual = 1.001 * largest;
  EXPECT_NO_THROW(run_element_test(start, path, options, {}));
  options.stop_energy_residual = 0.999 * largest;
  EXPECT_THROW(run_element_test(start, path, options, {}), Error);
  EXPECT_EQ(largest_energy_residual({}), 0);
}

TEST(ElementTest, RefusesImpossibleOptions) {
  const State start = relaxed_packing(20, 0.75);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.01)});
  ElementTestOptions options = fast_options(0);
  EXPECT_THROW(run_element_test(start, path, options, {}), InvalidInput);
  options = fast_options();
  options.drive.strain_rate = 0;
  EXPECT_THROW(run_element_test(start, path, options, {}), InvalidInput);
  options.drive.strain_rate = 1e-30;
  EXPECT_THROW(run_element_test(start, path, options, {}), InvalidInput);
  EXPECT_THROW(run_element_test(State{}, path, fast_options(), {}), InvalidInput);
}

TEST(ElementTest, StopsOnRequestAndReportsProgress) {
  const State start = relaxed_packing(20, 0.75);
  const auto path = path_of(start, {segment(Mode::UNI, ExtentKind::eps_vol, 0.05)});
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::vector<Progress> reports;
  control.report = [&](const Progress& progress) { reports.push_back(progress); };
  std::uint64_t steps = 0;
  EXPECT_THROW(run_element_test(start, path, fast_options(), control,
                                [&](Stepper&, int, double) {
                                  if (++steps == 100) stop.request_stop();
                                }),
               Interrupted);
  EXPECT_EQ(steps, 100u);
  ASSERT_FALSE(reports.empty());
  EXPECT_EQ(reports.front().work, 20);
  EXPECT_GT(reports.front().fraction, 0);
  EXPECT_LT(reports.front().fraction, 1);
}

// A saved state carries all that the run remembers: continued from the file it takes the same bits to the end.
TEST(ElementTest, ARunContinuesFromAFileBitForBit) {
  const State start = relaxed_packing(60, 0.72);
  const auto path = path_of(start, {segment(Mode::D2, ExtentKind::eps_dev, 0.08)});
  const ElementTestOptions options = fast_options();
  const auto file = std::filesystem::temp_directory_path() / ("grainlaw-continue-" + std::to_string(::getpid()));
  const std::uint64_t interrupted_at = 700;
  const ElementTest whole = run_element_test(start, path, options, {}, [&](Stepper& stepper, int, double) {
    Simulation& sim = stepper.simulation();
    if (sim.step() != interrupted_at) return;
    write_state(file, sim.state());
  });
  ASSERT_GT(whole.steps, 2 * interrupted_at);

  const Drive drive = make_drive(path[0], options.drive, start.packing.H);
  State saved = read_state(file);
  std::filesystem::remove(file);
  CellMotion motion = motion_at(drive, saved.time);
  motion.H = saved.packing.H;
  Simulation sim(saved, options.engine, motion);
  sim.set_dt(whole.time_step);
  for (std::uint64_t k = interrupted_at; k < whole.steps; ++k) {
    const double t = k + 1 == whole.steps ? drive.duration : static_cast<double>(k + 1) * sim.dt();
    scene::step(sim, motion_at(drive, (static_cast<double>(k) + 0.5) * sim.dt()), motion_at(drive, t));
  }
  EXPECT_EQ(sim.state().packing.sx, whole.end.packing.sx);
  EXPECT_EQ(sim.state().packing.vz, whole.end.packing.vz);
  EXPECT_EQ(sim.state().ay, whole.end.ay);
  EXPECT_EQ(sim.state().ledger.W_box, whole.end.ledger.W_box);
  EXPECT_EQ(sim.state().ledger.D_background, whole.end.ledger.D_background);
  EXPECT_EQ(sim.time(), whole.end.time);
}

}  // namespace
}  // namespace grainlaw::dem
