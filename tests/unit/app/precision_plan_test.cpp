#include "app/precision_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/staged_laws.hpp"
#include "model/student.hpp"

namespace grainlaw::app {
namespace {

/// The published law, each parameter known to `error` of its value with one packing, and as well as that allows with more.
fit::Calibration calibrated(int packings, double error, double bias) {
  fit::Calibration c = fit::nothing_known();
  c.parameters = published_parameters();
  c.parameters.anisotropy.a2 = 1.18;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (name.starts_with("memory") || name == "anisotropy.a0") continue;
    const double value = *fields(c.parameters)[i], se = error * std::abs(value) / std::sqrt(packings);
    c.estimates[i] = {value, se, fit::Status::fitted, ""};
    c.estimates[i].degrees_of_freedom = packings - 1;
    c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = se * se;
  }
  fit::Stage stage;
  stage.name = "evolution";
  for (const char* test : {"D2-0.70-s1", "D2-0.70-s2", "D2-0.78-s1", "D2-0.78-s2"}) {
    stage.tests.push_back({test, "s_par", true, 100, 0, 0, 0.1, bias * 0.2, 0.2});
    // of opposite sign in the packings: scatter, not discrepancy
    stage.tests.push_back({test, "F_par", true, 100, 0, 0, 0.1, std::string(test).ends_with("1") ? 0.05 : -0.05, 0.1});
  }
  c.stages.push_back(stage);
  return c;
}

Path shear() { return {0.72, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}}; }

struct Reached {
  PrecisionPlan plan;
  std::vector<std::size_t> packings;  // of each call
};

Reached reached(double target, double max_seconds, double error, double bias) {
  Reached r;
  double time = 0;
  Spec spec;
  spec.seeds = {4, 9};
  r.plan = reach(
      {target, shear(), max_seconds}, spec,
      [&](const Spec& with) {
        r.packings.push_back(with.seeds.size());
        time = 10.0 * static_cast<double>(with.seeds.size());
        return calibrated(static_cast<int>(with.seeds.size()), error, bias);
      },
      [&] { return time; }, [](const std::string&) {});
  return r;
}

TEST(PrecisionPlan, PackingsFollowStudentsTOverTheRoot) {
  for (const int n : {2, 3, 5, 10}) {
    const double width = 0.1, wanted = 0.03;
    const int needed = packings_needed(width, n, wanted);
    const auto at = [&](int m) { return width * student_95(m - 1) / student_95(n - 1) * std::sqrt(double(n) / m); };
    EXPECT_LE(at(needed), wanted);
    EXPECT_GT(at(needed - 1), wanted);
  }
  EXPECT_EQ(packings_needed(0.02, 5, 0.02), 5);
}

TEST(PrecisionPlan, AddsPackingsUntilTheBandIsNarrowEnough) {
  const Reached r = reached(0.02, 0, 0.02, 0.001);
  EXPECT_EQ(r.plan.outcome, PlanOutcome::met);
  EXPECT_EQ(r.packings.front(), 3u);
  ASSERT_GE(r.plan.rounds.size(), 2u);
  EXPECT_GT(r.plan.rounds.front().error.half_width, 0.02);
  EXPECT_LE(r.plan.rounds.back().error.half_width, 0.02);
  EXPECT_EQ(r.plan.rounds.back().error.rung, Rung::evolution);
  // one round fewer packings would not have done: what is made beyond the need is the slack of a twentieth
  EXPECT_LE(r.packings.back(), std::ceil(1.05 * packings_needed(r.plan.rounds.front().error.half_width, 3, 0.02)) + 1);
}

TEST(PrecisionPlan, StopsWhereMorePackingsDoNotHelp) {
  const Reached biased = reached(0.02, 0, 0.02, 0.05);
  EXPECT_EQ(biased.plan.outcome, PlanOutcome::discrepancy);
  EXPECT_EQ(biased.packings.size(), 1u);
  EXPECT_NEAR(biased.plan.rounds.front().error.discrepancy, 0.05, 1e-12);
  const Reached slow = reached(0.02, 45, 0.05, 0);
  EXPECT_EQ(slow.plan.outcome, PlanOutcome::max_cost);
  EXPECT_LE(slow.plan.rounds.back().seconds, 45);
  EXPECT_EQ(slow.packings.back(), 4u);
  EXPECT_EQ(reached(0.02, 0, 0, 0).plan.outcome, PlanOutcome::no_band);
}

}  // namespace
}  // namespace grainlaw::app
