#include "chain/planning/planned_spec.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "dem/runs/dataset_runs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

dem::Spec frame() {
  return dem::spec_from_json(
      Json::parse(R"({"particles": 4000, "seeds": [7, 3], "strain_rate": 138, "nu_end": 0.67, "size_width": 2,
    "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"},
              {"mode": "D2-ISO", "density": [0.7, 0.74], "role": "calibration"},
              {"mode": "UNI", "density": 0.7, "strain": 0.02, "role": "validation"}]})"),
      "frame");
}

Path path(double from, double to) {
  return {from, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, to}}};
}

TEST(PlannedSpec, DensitiesAreWhereThePathGoes) {
  const dem::PreparationOptions o = frame().preparation;
  EXPECT_EQ(densities_for(path(0.70, 0.79), 4, o), (std::vector<double>{0.70, 0.73, 0.76, 0.79}));
  EXPECT_EQ(densities_for(path(0.72, 0.74), 3, o), (std::vector<double>{0.69, 0.73, 0.77}));
  // what is not fitted, or has not settled yet, is left out
  EXPECT_EQ(densities_for(path(0.671, 0.82), 2, o), (std::vector<double>{0.675, 0.81}));
  const Path shear{0.81, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}};
  EXPECT_EQ(densities_for(shear, 2, o), (std::vector<double>{0.73, 0.81}));
}

TEST(PlannedSpec, KeepsTheFrame) {
  const dem::Spec spec = planned_spec(frame(), {500, 4, 276, 0.05, 4, 0.21}, path(0.70, 0.79));
  EXPECT_EQ(spec.preparation.packing.particles, 500);
  EXPECT_EQ(spec.preparation.packing.size_width, 2);
  EXPECT_EQ(spec.preparation.drive.strain_rate, 276);
  EXPECT_EQ(spec.preparation.engine.time_step_fraction, 0.05);
  EXPECT_EQ(spec.seeds, (std::vector<std::uint64_t>{7, 3, 8, 9}));
  ASSERT_EQ(spec.tests.size(), 5u);
  EXPECT_EQ(spec.tests[1].densities, (std::vector<double>{0.70, 0.73, 0.76, 0.79}));
  EXPECT_EQ(spec.tests[1].strain, 0.21);
  EXPECT_EQ(spec.tests[2].densities, (std::vector<double>{0.70, 0.73, 0.76}));
  EXPECT_EQ(spec.tests[3].densities, (std::vector<double>{0.7}));
  // what is not for the plan is left for later, on the same packings
  const dem::Spec first = rounds_of(spec);
  EXPECT_EQ(first.tests.size(), 4u);
  EXPECT_EQ(first.preparation.keep_unloading, spec.preparation.keep_unloading);
}

TEST(PlannedSpec, RehearsesThePath) {
  const dem::Spec spec = planned_spec(frame(), {500, 2, 276, 0.05, 4, 0.21}, path(0.695, 0.79));
  const auto tests = plan(rounds_of(spec));
  const dem::PlannedTest& last = tests.back();
  EXPECT_EQ(last.name, "rehearsal-0.695-s3");
  EXPECT_EQ(last.role, Role::validation);  // never fitted
  EXPECT_EQ(last.path.nu, 0.695);
  EXPECT_EQ(last.path.segments.size(), 1u);
  EXPECT_NEAR(resolve(last.path).back().nu(resolve(last.path).back().length), 0.79, 1e-12);
  EXPECT_EQ(last.preparation.keep_unloading, tests.front().preparation.keep_unloading);  // from the same packings
}

TEST(PlannedSpec, DoesNotFitThePath) {
  const Path shear{0.81, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.21}}};
  const dem::Spec spec = planned_spec(frame(), {500, 2, 276, 0.05, 4, 0.21}, shear);
  EXPECT_EQ(spec.tests[1].densities, (std::vector<double>{0.73, 0.757, 0.783}));
  EXPECT_EQ(planned_spec(frame(), {500, 2, 276, 0.05, 4, 0.3}, shear).tests[1].densities.size(), 4u) << "goes on";
  dem::Spec fitting = frame();  // the frame's own test at its only density
  fitting.tests[3].role = Role::calibration;
  const Path uniaxial = dem::path_of(fitting.tests[3], 0.7, fitting);
  EXPECT_NE(testing::refusal([&] {
              planned_spec(fitting, {500, 2, 276, 0.05, 4, 0.21}, uniaxial);
            }).find("'rehearsal-0.70-s7' (validation) is the run of tests[3] (calibration)"),
            std::string::npos);
}

TEST(PlannedSpec, TheGridHoldsThePilotAndTheWantedRate) {
  const PlanSettings pilot = pilot_settings(frame(), "spec.json");
  EXPECT_EQ(pilot.strain_rate, 138 * 8);
  const auto grid = plan_grid(pilot, 138);
  EXPECT_TRUE(std::any_of(grid.begin(), grid.end(), [&](const auto& s) { return same_packings(s, pilot); }));
  EXPECT_TRUE(std::any_of(grid.begin(), grid.end(), [](const auto& s) { return s.strain_rate == 138; }));
  EXPECT_TRUE(std::all_of(grid.begin(), grid.end(), [](const auto& s) { return s.strain_rate >= 138; }));
  dem::Spec fast = frame();
  fast.preparation.drive.strain_rate = 3000;  // faster than a pilot would be
  EXPECT_EQ(pilot_settings(fast, "spec.json").strain_rate, 3000);
}

TEST(PlannedSpec, WorkFollowsFromTheSettings) {
  const PlanSettings a{400, 4, 1104, 0.1, 4, 0.3}, b{800, 6, 276, 0.05, 4, 0.3};
  const Work at = work_of(planned_spec(frame(), a, path(0.7, 0.79))),
             other = work_of(planned_spec(frame(), b, path(0.7, 0.79)));
  EXPECT_EQ(at.fitted_tests, 8);   // ISO, four D2, three D2-ISO
  EXPECT_EQ(at.relaxed, 400 * 4);  // .70 .73 .76 .79, that of UNI among them
  const Work expected = scaled(at, a, b);
  EXPECT_NEAR(other.preparation, expected.preparation, 1e-3 * expected.preparation);
  EXPECT_NEAR(other.tests, expected.tests, 1e-3 * expected.tests);
  EXPECT_EQ(other.relaxed, expected.relaxed);
}

}  // namespace
}  // namespace grainlaw::chain
