#include "chain/planning/precision_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/student.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::chain {
namespace {

using testing::kInfinity;

/// Ten packings of 100 know it to `width`; at rate 1 the rate alone spoils it by `rate`, a hundred spheres by `size`.
PlanFindings findings(double width, double rate, double size) {
  PlanFindings f;
  f.scale = {{100, 10, 1, 0.1, 4, 0.3}, 0};
  f.reference = f.scale.pilot;
  QuantityFindings q{"s_par", width, {{0.21, 0.01, 0.06}, {0.3, 0.01, 0.04}}, {}};
  q.biases[0].slope = rate;
  q.biases[2].slope = size;
  f.quantities = {q};
  f.rates = {1, 0, 0};
  return f;
}

/// A packing costs its spheres over its rate.
Work work(const PlanSettings& s) { return {static_cast<double>(s.particles) / s.strain_rate, 0, 0, 0}; }

PlanGoal goal(double error, double seconds_left = kInfinity) { return {error, seconds_left, {}, kInfinity, 100000}; }

TEST(PrecisionPlan, BandsFollowStudentsTOverTheRootOfAllSpheres) {
  const PlanFindings f = findings(0.08, 0, 0);
  PlanSettings s = f.reference;
  s.particles = 300;
  s.packings = 4;
  const double factor = student_95(3) / std::sqrt(4 * 300) / (student_95(9) / std::sqrt(10 * 100));
  EXPECT_NEAR(expected(f.quantities[0], f, s).half_width, 0.08 * factor, 1e-15);
  // densities share what is common to a packing, and nothing else
  s = f.reference;
  s.densities = 8;
  s.shear_strain = 0.21;
  EXPECT_NEAR(expected(f.quantities[0], f, s).half_width, 0.08 * std::sqrt((0.01 + 0.06 / 8) / (0.01 + 0.04 / 4)),
              1e-15);
}

TEST(PrecisionPlan, BiasesFollowTheirOrders) {
  PlanFindings f = findings(0.08, 0.03, 0.02);
  f.scale.wanted_rate = 0.25;
  f.quantities[0].biases[1].slope = 0.01;
  PlanSettings s = f.reference;
  s.strain_rate = 4;
  s.time_step_fraction = 0.05;
  s.particles = 800;
  const ExpectedError e = expected(f.quantities[0], f, s);
  EXPECT_NEAR(e.biases[0], 0.03 * (std::pow(4, 0.6) - std::pow(0.25, 0.6)), 1e-15);
  EXPECT_NEAR(e.biases[1], 0.01 / 4, 1e-15);
  EXPECT_NEAR(e.biases[2], 0.02 / 8, 1e-15);
  EXPECT_NEAR(
      e.total() * e.total(),
      e.half_width * e.half_width + e.biases[0] * e.biases[0] + e.biases[1] * e.biases[1] + e.biases[2] * e.biases[2],
      1e-15);
  s.strain_rate = 0.25;  // as wanted
  EXPECT_EQ(expected(f.quantities[0], f, s).biases[0], 0);
}

TEST(PrecisionPlan, ADifferenceBelowItsErrorIsNoBias) {
  const Bias seen = bias_of(-0.05, 0.03, 2);
  EXPECT_NEAR(seen.slope, 0.04 / 2, 1e-15);
  EXPECT_NEAR(seen.resolution, 0.03, 1e-15);
  EXPECT_EQ(bias_of(0.02, 0.03, 2).slope, 0);
}

TEST(PrecisionPlan, AFurtherRoundChangesNothingThatWasExpected) {
  const PlanFindings f = findings(0.08, 0.03, 0.02);
  PlanSettings reached = f.reference, s = f.reference;
  reached.particles = 700;
  reached.densities = 6;
  const PlanFindings later = rebased(f, reached, {expected(f.quantities[0], f, reached).half_width});
  s.packings = 5;
  s.strain_rate = 2;
  const ExpectedError before = expected(f.quantities[0], f, s), after = expected(later.quantities[0], later, s);
  EXPECT_NEAR(after.half_width, before.half_width, 1e-15);
  EXPECT_EQ(after.biases, before.biases);
}

TEST(PrecisionPlan, TakesTheSmallestNumberOfPackingsThatReaches) {
  const PlanFindings f = findings(0.08, 0.01, 0.01);
  const Candidate c = *candidate(f.reference, work(f.reference), f, goal(0.03));
  EXPECT_TRUE(c.reaches);
  PlanSettings fewer = c.settings;
  --fewer.packings;
  EXPECT_GT(candidate_with(fewer, c.work, f, goal(0.03)).error, 0.03);
  EXPECT_DOUBLE_EQ(c.seconds, 100.0 * c.settings.packings);
  EXPECT_FALSE(candidate(f.reference, work(f.reference), f, goal(0.0141))->reaches);  // the biases alone are larger
}

/// n N/r is the cost, A/(n N) + (b r^0.6)^2 = E^2: least where b^2 r^1.2 is E^2/(1 + 1.2).
TEST(PrecisionPlan, FindsTheAnalyticOptimum) {
  const double target = 0.01;
  const PlanFindings f = findings(0.08, 0.05, 0);
  std::vector<Candidate> candidates;
  for (double rate = 1e-3; rate < 1; rate *= 1.05) {
    PlanSettings s = f.reference;
    s.particles = 1;  // so many packings that t is 1.96 and their number fine
    s.strain_rate = rate;
    candidates.push_back(*candidate(s, work(s), f, goal(target)));
  }
  const Candidate& best = candidates.at(*choose(candidates, goal(target)));
  EXPECT_NEAR(best.errors[0].biases[0] * best.errors[0].biases[0] / (target * target), 1 / 2.2, 0.03);
}

TEST(PrecisionPlan, ASmallerTargetIsNeverCheaper) {
  const PlanFindings f = findings(0.08, 0.02, 0.02);
  std::vector<PlanSettings> grid;
  for (const int size : {1, 4, 16, 64}) {
    for (const double rate : {1.0, 0.1, 0.01, 0.001}) {
      for (const int densities : {4, 8}) {
        PlanSettings s = f.reference;
        s.particles *= size;
        s.strain_rate = rate;
        s.densities = densities;
        grid.push_back(s);
      }
    }
  }
  double last = 0;
  for (double target = 0.5; target > 2e-3; target /= 1.1) {
    std::vector<Candidate> candidates;
    for (const PlanSettings& s : grid) candidates.push_back(*candidate(s, work(s), f, goal(target)));
    const auto chosen = choose(candidates, goal(target));
    ASSERT_TRUE(chosen) << target;
    EXPECT_LE(candidates[*chosen].error, target);
    EXPECT_GE(candidates[*chosen].seconds, last) << target;
    last = candidates[*chosen].seconds;
  }
  EXPECT_GT(last, 1e6);
}

TEST(PrecisionPlan, KeepsToTheTimeThatIsLeft) {
  const PlanFindings f = findings(0.08, 0, 0);
  const auto c = candidate(f.reference, work(f.reference), f, goal(0.001, 1750));
  ASSERT_TRUE(c);
  EXPECT_EQ(c->settings.packings, 17);
  EXPECT_FALSE(c->reaches);
  EXPECT_FALSE(candidate(f.reference, work(f.reference), f, goal(0.001, 299)));  // three packings take longer
  // the best of what can be paid for, if it is better than what there is
  PlanSettings cheap = f.reference;
  cheap.strain_rate = 4;
  const std::vector<Candidate> both{*c, *candidate(cheap, work(cheap), f, goal(0.001, 1750))};
  PlanGoal now = goal(0.001, 1750);
  EXPECT_EQ(choose(both, now), 1u);
  now.error_now = 1e-3;
  EXPECT_EQ(choose(both, now), std::nullopt);
  now = goal(0.001);  // without a limit, what does not reach is no plan
  EXPECT_EQ(choose(both, now), std::nullopt);
}

TEST(PrecisionPlan, FinishedPackingsCostNothingButTheirFit) {
  PlanFindings f = findings(0.08, 0, 0);
  f.rates = {1, 2, 3};
  const Work each{70, 30, 5, 7};
  PlanGoal of = goal(0.04);
  of.finished = {f.reference};
  const Candidate more = *candidate(f.reference, each, f, of);
  EXPECT_DOUBLE_EQ(more.seconds, (more.settings.packings - 10) * (100 + 10) + more.settings.packings * 21);
  of.finished[0].strain_rate = 2;
  EXPECT_DOUBLE_EQ(candidate(f.reference, each, f, of)->seconds, more.settings.packings * 131.0);
  // what is finished already is no plan
  EXPECT_EQ(candidate(f.reference, each, f, {1, kInfinity, {f.reference}, kInfinity, 1000})->settings.packings, 11);
  // nor is an earlier round forgotten
  of.finished.insert(of.finished.begin(), f.reference);
  EXPECT_DOUBLE_EQ(candidate(f.reference, each, f, of)->seconds, more.seconds);
}

TEST(PrecisionPlan, WorkScalesWithSizeRateAndStep) {
  const PlanSettings at{100, 10, 1, 0.1, 4, 0.3};
  PlanSettings s = at;
  s.particles = 300;
  s.strain_rate = 0.5;
  s.time_step_fraction = 0.05;
  const Work w = scaled({8, 4, 2, 1}, at, s);
  EXPECT_DOUBLE_EQ(w.preparation, 8 * 12);
  EXPECT_DOUBLE_EQ(w.tests, 4 * 12);
  EXPECT_DOUBLE_EQ(w.relaxed, 2 * 3);
  EXPECT_EQ(w.fitted_tests, 1);
}

}  // namespace
}  // namespace grainlaw::chain
