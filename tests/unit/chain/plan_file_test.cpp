#include "chain/planning/target_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/files/schema.hpp"

namespace grainlaw::chain {
namespace {

TEST(PlanFile, IsWhatItsSchemaSays) {
  const PrecisionTarget target{
      0.02, {"P_star"}, {0.72, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.2}}}, 60};
  TargetRun run;
  run.pilot.scale = {{400, 4, 1104, 0.1, 4, 0.3}, 138};
  run.pilot.reference = run.pilot.scale.pilot;
  QuantityFindings q{"P_star", 0.03, {{0.3, 1e-4, 2e-4}}, {}};
  q.biases[0] = bias_of(0.05, 0.01, 2);
  q.biases[1] = {std::nan(""), std::nan(""), 1e-3, 0};
  run.pilot.quantities = {q};
  run.candidates = {{{800, 5, 552, 0.1, 4, 0.3}, {}, {}, 0.018, 12.5, true}};
  TargetRound round{run.pilot.reference,
                    std::nan(""),
                    std::nan(""),
                    9,
                    {Rung::memory, {{"P_star", std::nan(""), 0.2, 0.01, 0}}},
                    {},
                    0.04};
  round.errors = {{"P_star", std::nan(""), {0.01, 0.002, 0.003}}};
  run.rounds = {round};
  const Json document = Json::parse(plan_to_json(run, target, {{"particles", 400}}, {{"grainlaw", "x"}}).dump());
  EXPECT_NO_THROW(check_schema(document, Schema::plan, "plan.json"));
  const Json& rate = document["pilot"]["quantities"][0]["biases"][0];
  EXPECT_EQ(rate["cause"], "strain_rate");
  // the slope is that between pilot and coarser setting; at the pilot it counts from the wanted rate
  EXPECT_NEAR(rate["estimate"].get<double>(),
              std::sqrt(0.05 * 0.05 - 0.01 * 0.01) / 2 * (1 - std::pow(138. / 1104, 0.6)), 1e-12);
  EXPECT_TRUE(document["rounds"][0]["expected_error"].is_null());
  EXPECT_TRUE(document["rounds"][0]["quantities"][0]["error"].is_null());
  EXPECT_EQ(document["candidates"][0]["packings"], 5);
}

}  // namespace
}  // namespace grainlaw::chain
