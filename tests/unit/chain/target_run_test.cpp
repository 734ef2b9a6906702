#include "chain/planning/target_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/student.hpp"

namespace grainlaw::chain {
namespace {

/// A world in which bands follow t/sqrt(n N) exactly, a sphere takes a hundredth of a second over the rate, and the law is
/// off by `discrepancy`, which is seen as well as the band allows.
struct World {
  double width = 1;      ///< t sqrt(1/(n N)) times this is the band
  double rate_bias = 0;  ///< at rate 8
  double discrepancy = 0;
  double pilot_luck = 1;  ///< the pilot's band over what it should be
  double blind = 0;       ///< later rounds of fewer spheres have no band
  double time = 0;
  std::vector<PlanSettings> calls;
  std::string log;

  PredictionError calibrate(const PlanSettings& s) {
    const bool more = !calls.empty() && same_packings(calls.back(), s);
    time += 0.01 * (s.packings - (more ? calls.back().packings : 0)) * static_cast<double>(s.particles) / s.strain_rate;
    const double luck = calls.empty() ? pilot_luck : 1;
    calls.push_back(s);
    const bool no_band = calls.size() > 1 && s.packings * static_cast<double>(s.particles) < blind;
    const double h =
        no_band ? std::nan("")
                : luck * width * student_95(s.packings - 1) / std::sqrt(s.packings * static_cast<double>(s.particles));
    return {Rung::memory, {{"P_star", h, 2 * h, discrepancy, std::max(0.0, discrepancy - h)}, {"s_par", 9, 9, 9, 9}}};
  }

  TargetRun reach(double target, double max_seconds = 0) {
    const PlanSettings pilot{400, 4, 8, 0.1, 4, 0.3};
    std::vector<PlanSettings> grid;
    for (const int size : {1, 4, 16}) {
      for (const double rate : {1., 2., 4., 8.}) {
        grid.push_back(pilot);
        grid.back().particles *= size;
        grid.back().strain_rate = rate;
      }
    }
    TargetActions actions;
    actions.calibrate = [this](const PlanSettings& s) { return calibrate(s); };
    actions.explore = [&](const PredictionError& known) {
      PlanFindings f{{pilot, 1}, pilot, {{"P_star", known.quantities[0].half_width, {{0.3, 1, 0}}, {}}}, {0.01, 0, 0}};
      f.quantities[0].biases[0].slope = rate_bias / (1 - std::pow(8, -0.6));
      return f;
    };
    actions.work = [](const PlanSettings& s) {
      return Work{static_cast<double>(s.particles) / s.strain_rate, 0, 0, 0};
    };
    actions.seconds = [this] { return time; };
    actions.log = [this](const std::string& text) { log += text + "\n"; };
    return chain::reach({target, {"P_star"}, {}, max_seconds}, pilot, grid, actions);
  }
};

TEST(TargetRun, ThePilotMayDo) {
  World world;
  const TargetRun run = world.reach(0.2);
  EXPECT_EQ(run.outcome, TargetOutcome::met);
  EXPECT_EQ(world.calls.size(), 1u);
  EXPECT_TRUE(run.candidates.empty());
}

TEST(TargetRun, GoesOnUntilTheErrorIsReached) {
  World world;
  const TargetRun run = world.reach(0.01);
  EXPECT_EQ(run.outcome, TargetOutcome::met);
  EXPECT_LE(run.rounds.back().error, 0.01);
  EXPECT_GT(run.rounds.front().error, 0.01);
  for (std::size_t i = 1; i < run.rounds.size(); ++i) {
    EXPECT_NEAR(run.rounds[i].error, run.rounds[i].expected_error, 1e-12) << i;  // in this world plans come true
    EXPECT_NEAR(run.rounds[i].seconds, run.rounds[i].expected_seconds, 1e-9) << i;
    const PlanSettings &now = world.calls[i], &before = world.calls[i - 1];
    // errors are at most halved, or three packings
    EXPECT_TRUE(now.packings == 3 || now.packings * now.particles <= 4 * before.packings * before.particles) << i;
  }
  EXPECT_NE(world.log.find("plan: "), std::string::npos);
}

TEST(TargetRun, LeavesTheFastSettingForASmallBias) {
  World world;
  world.rate_bias = 0.05;
  const TargetRun run = world.reach(0.02);
  EXPECT_EQ(run.outcome, TargetOutcome::met);
  EXPECT_LT(world.calls.back().strain_rate, 8);
  EXPECT_LE(run.rounds.back().errors[0].biases[0], 0.02);
  EXPECT_GT(run.rounds.back().errors[0].biases[0], 0);
  world = {};
  EXPECT_EQ(world.reach(0.02).rounds.back().settings.strain_rate, 8);  // where it does no harm it stays
}

TEST(TargetRun, MendsWhatAnUnluckyPilotSaid) {
  for (const double luck : {0.4, 3.}) {
    World world;
    world.pilot_luck = luck;
    const TargetRun run = world.reach(0.015);
    EXPECT_EQ(run.outcome, TargetOutcome::met);
    EXPECT_LE(run.rounds.back().error, 0.015);
  }
}

TEST(TargetRun, StopsWhereTheLawIsWrong) {
  World world;
  world.discrepancy = 0.05;
  const TargetRun run = world.reach(0.01);
  EXPECT_EQ(run.outcome, TargetOutcome::discrepancy);
  EXPECT_GT(run.rounds.back().error, 0.01);  // as soon as it is sure
  EXPECT_LT(run.rounds.back().error, 0.05);
  World small;
  small.discrepancy = 0.05;
  EXPECT_EQ(small.reach(0.051).outcome, TargetOutcome::met);
}

TEST(TargetRun, KeepsToItsTime) {
  World world;
  const TargetRun run = world.reach(0.001, 60);
  EXPECT_EQ(run.outcome, TargetOutcome::max_cost);
  EXPECT_LE(world.time, 60);
  EXPECT_GT(world.time, 30);
  EXPECT_LT(run.rounds.back().error, run.rounds.front().error / 2);
  World tiny;
  EXPECT_EQ(tiny.reach(0.001, 0.001).outcome, TargetOutcome::max_cost);
  EXPECT_EQ(tiny.calls.size(), 1u);
}

TEST(TargetRun, PlansByWhatItKnewBeforeARoundWithoutABand) {
  World world;
  const TargetRun seeing = world.reach(0.05);
  ASSERT_EQ(seeing.rounds.size(), 2u);
  const auto spheres = [](const TargetRound& round) {
    return round.settings.packings * static_cast<double>(round.settings.particles);
  };
  world = {};
  world.blind = spheres(seeing.rounds[1]) + 1;
  const TargetRun run = world.reach(0.05);
  EXPECT_EQ(run.outcome, TargetOutcome::met);
  ASSERT_EQ(run.rounds.size(), 3u);
  EXPECT_TRUE(std::isnan(run.rounds[1].error));
  EXPECT_LE(run.rounds[2].expected_error, 0.05);  // by the pilot, not as if nothing were known
  EXPECT_GE(spheres(run.rounds[2]), 2 * spheres(run.rounds[1]));
  EXPECT_LT(spheres(run.rounds[2]), 3 * spheres(run.rounds[1]));
}

TEST(TargetRun, GivesUpWithoutABand) {
  World world;
  world.width = std::nan("");
  const TargetRun run = world.reach(0.1);
  EXPECT_EQ(run.outcome, TargetOutcome::no_band);
  EXPECT_EQ(world.calls.size(), 3u);
  EXPECT_NE(world.log.find("P_star has no band"), std::string::npos) << world.log;
  EXPECT_EQ(world.log.find("nan"), std::string::npos) << world.log;
}

}  // namespace
}  // namespace grainlaw::chain
