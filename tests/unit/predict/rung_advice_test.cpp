#include "predict/rung_advice.hpp"

#include <gtest/gtest.h>

#include "tests/support/law_path.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;
using testing::leg_to;
using testing::path_from;

RungAdvice needed(double nu, std::vector<PathSegment> legs) {
  return rung_needed(published_parameters(), path_from(nu, std::move(legs)));
}

TEST(RungAdvice, NamesTheCheapestRung) {
  EXPECT_EQ(needed(0.72, {leg_to(Mode::ISO, 0.8)}).rung, Rung::reduced);
  EXPECT_EQ(needed(0.80, {leg(Mode::D2, 0.3)}).rung, Rung::reduced) << "P* falls by .7 % (Table 2)";
  EXPECT_EQ(needed(0.72, {leg_to(Mode::UNI, 0.8)}).rung, Rung::evolution);
  EXPECT_EQ(needed(0.80, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.82)}).rung, Rung::evolution);
  EXPECT_EQ(needed(0.80, {leg(Mode::D2, 0.1), leg(Mode::D3, 0.1)}).rung, Rung::reduced) << "D3 is 30 degrees from D2";
}

TEST(RungAdvice, SaysWhy) {
  const RungAdvice turns = needed(0.80, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.81), leg(Mode::D2, 0.1, true)});
  EXPECT_EQ(turns.rung, Rung::memory);
  EXPECT_EQ(turns.why, "segments[2] turns the shear back");
  const RungAdvice dilates = needed(0.68, {leg(Mode::D2, 0.1)});
  EXPECT_EQ(dilates.rung, Rung::memory);
  EXPECT_NE(dilates.why.find("changes P* by +39"), std::string::npos) << dilates.why;
}

TEST(RungAdvice, SpinTurnsTheStateAgainstItsShear) {
  auto path = path_from(0.80, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.1)});
  const auto spun_by = [&path](double angle) {
    path[1].spin(0, 2) = angle / path[1].length;
    path[1].spin(2, 0) = -path[1].spin(0, 2);
    return rung_needed(published_parameters(), path);
  };
  EXPECT_EQ(spun_by(0.5).rung, Rung::reduced);
  EXPECT_EQ(spun_by(1.5).why, "the spin of segments[1] turns the state against its shear");
}

TEST(RungAdvice, RehearsalsOverruleWhatThePathContains) {
  const auto path = path_from(0.72, {leg_to(Mode::UNI, 0.8)});
  const RungAdvice advice = rung_needed(published_parameters(), path);
  ASSERT_EQ(advice.rung, Rung::evolution);
  const std::vector<Rung> rungs{Rung::reduced, Rung::evolution, Rung::memory};
  const RungRecommendation without = recommended_rung({}, path, rungs, advice);
  EXPECT_EQ(without.rung, Rung::evolution);
  EXPECT_FALSE(without.rehearsed);
  EXPECT_NE(without.why.find("no path was rehearsed"), std::string::npos);
  EXPECT_EQ(recommended_rung({}, path, {Rung::memory}, advice).rung, Rung::memory) << "all there is";

  Rehearsal r;
  r.path = {0.70, Branch::unloading, {leg_to(Mode::UNI, 0.8)}};
  const auto off = [](double error) { return RehearsedQuantity{90, error * error, 0, error}; };
  r.rungs = {{Rung::reduced, off(0.001), off(0.05), off(0.05)},
             {Rung::evolution, off(0.001), off(0.05), off(0.20)},
             {Rung::memory, off(0.0005), off(0.05), off(0.05)}};
  const RungRecommendation with = recommended_rung({r}, path, rungs, advice);
  EXPECT_EQ(with.rung, Rung::memory);
  EXPECT_TRUE(with.rehearsed);
  EXPECT_NE(with.why.find("evolution errs 2.0, 1.0 and 4.0 times as much"), std::string::npos) << with.why;
}

TEST(RungAdvice, DifferenceIsTheLargestOverCommonRows) {
  Prediction a, b;
  PredictedRow row;
  row.state = {0.02, Deviator<double>::Zero(), Deviator<double>::Zero()};
  a.rows = {row, row, row};
  b.rows = {row, row};
  b.rows[1].state.P = 0.021;
  b.rows[1].state.sigma(0) = 0.0021;
  b.rows[0].state.F(3) = -0.03;
  const RungDifference d = difference(a, b);
  EXPECT_NEAR(d.P, 0.05, 1e-12);
  EXPECT_NEAR(d.s, 0.1, 1e-12);
  EXPECT_NEAR(d.F, 0.03, 1e-12);
}

}  // namespace
}  // namespace grainlaw::predict
