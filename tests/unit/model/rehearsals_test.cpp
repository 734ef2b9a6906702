#include "model/rehearsals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using testing::leg;
using testing::leg_to;
using testing::path_from;
using testing::path_of;

/// A rehearsal of `path`, off by `error` in units of w in every quantity of the named rungs.
Rehearsal rehearsal(const Path& path, const std::vector<std::pair<Rung, double>>& errors, double known = 0) {
  Rehearsal r;
  r.path = path;
  r.traits = traits_of(resolve(path));
  r.kind = kind_of(r.traits);
  r.packings = 3;
  for (const auto& [rung, error] : errors) {
    const RehearsedQuantity q{100, error * error, known, 2 * error};
    r.rungs.push_back({rung, q, q, q});
  }
  return r;
}

/// Monotone paths by the errors of memory.
std::vector<Rehearsal> monotone(const std::vector<double>& errors, double known = 0) {
  std::vector<Rehearsal> all;
  for (std::size_t i = 0; i < errors.size(); ++i)
    all.push_back(rehearsal(path_of(0.70 + 0.01 * static_cast<double>(i), {leg(Mode::D2, 0.2)}),
                            {{Rung::memory, errors[i]}}, known));
  return all;
}

PathKind kind(double nu, std::vector<PathSegment> legs) { return kind_of(traits_of(path_from(nu, std::move(legs)))); }

TEST(Rehearsals, KindFollowsFromThePath) {
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1)}), PathKind::monotone);
  EXPECT_EQ(kind(0.70, {leg_to(Mode::UNI, 0.8)}), PathKind::monotone);
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.8), leg(Mode::D2, 0.1)}), PathKind::monotone);
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1), leg(Mode::D3, 0.1)}), PathKind::turning) << "30 degrees";
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1), leg(Mode::D3, 0.1), leg(Mode::D2, 0.1)}), PathKind::turning)
      << "30 degrees and back, which reverses nothing";
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.1, true)}), PathKind::turning) << "once";
  EXPECT_EQ(kind(0.70, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.1, true), leg(Mode::D2, 0.1)}), PathKind::cyclic);
  EXPECT_EQ(kind(0.70, {leg_to(Mode::UNI, 0.8), leg_to(Mode::UNI, 0.75, true)}), PathKind::unloading);
  EXPECT_EQ(kind(0.80, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.75, true)}), PathKind::unloading);
}

TEST(Rehearsals, TraitsAreThoseOfTheWholePath) {
  const PathTraits t = traits_of(path_from(
      0.75, {leg(Mode::D2, 0.15), leg(Mode::D2, 0.3, true), leg(Mode::D3, 0.1), leg_to(Mode::ISO, 0.70, true)}));
  EXPECT_NEAR(t.nu_min, 0.70, 1e-12);
  EXPECT_NEAR(t.nu_max, 0.75, 1e-12);
  EXPECT_NEAR(t.eps_dev, 0.15, 1e-9);
  EXPECT_NEAR(t.shear_path, 0.55, 1e-12);
  EXPECT_NEAR(t.lode_min, 0, 1e-12);
  EXPECT_NEAR(t.lode_max, 1, 1e-12);
  EXPECT_EQ(t.turns, 2);
  EXPECT_EQ(t.reversals, 2) << "D2 backwards to D3 is 150 degrees";
  EXPECT_TRUE(t.expands);
}

TEST(Rehearsals, TauIsWhatChanceDoesNotExplain) {
  const auto path = path_from(0.77, {leg(Mode::D2, 0.2)});
  const std::vector<Rehearsal> paths = monotone({0.03, 0.04, 0.05, 0.06}, 0.0002);
  const LawError error = law_error(spokesmen_for(path, paths), Rung::memory, Rehearsed::s_par);
  const double square = (9 + 16 + 25 + 36) * 1e-4 / 4;
  EXPECT_NEAR(error.rms, std::sqrt(square), 1e-15);
  EXPECT_NEAR(error.tau, std::sqrt(square - 0.0002), 1e-15);
  EXPECT_EQ(error.degrees_of_freedom, 4);
  EXPECT_EQ(error.largest, 0.12);
  EXPECT_EQ(law_error(spokesmen_for(path, monotone({0.01, 0.01}, 0.0002)), Rung::memory, Rehearsed::s_par).tau, 0)
      << "chance alone";
  EXPECT_TRUE(std::isnan(law_error(spokesmen_for(path, paths), Rung::reduced, Rehearsed::s_par).tau)) << "no rung";
}

TEST(Rehearsals, OfItsKindWhereThereAreEnough) {
  std::vector<Rehearsal> paths = monotone({0.03, 0.04, 0.05, 0.06});
  paths.push_back(rehearsal(path_of(0.7, {leg(Mode::D2, 0.1), leg(Mode::D3, 0.1)}), {{Rung::memory, 1}}));
  const Spokesmen alike = spokesmen_for(path_from(0.77, {leg(Mode::D2, 0.2)}), paths);
  EXPECT_TRUE(alike.of_kind);
  EXPECT_EQ(alike.rehearsals.size(), 4u);
  const Spokesmen all = spokesmen_for(path_from(0.77, {leg(Mode::D2, 0.1), leg(Mode::D3, 0.1)}), paths);
  EXPECT_FALSE(all.of_kind);
  EXPECT_EQ(all.rehearsals.size(), 5u);
}

TEST(Rehearsals, APathDoesNotSpeakForItself) {
  const std::vector<Rehearsal> paths = monotone({0.03, 0.04, 0.05, 0.06, 0.07});
  const Spokesmen others = spokesmen_for(resolve(paths[2].path), paths);
  ASSERT_EQ(others.rehearsals.size(), 4u);
  for (const Rehearsal* other : others.rehearsals) EXPECT_NE(other, &paths[2]);
  Path again = paths[2].path;  // on a packing that somebody else's program made
  again.nu += 4e-4;
  again.segments.front().extent *= 1.005;
  EXPECT_EQ(spokesmen_for(resolve(again), paths).rehearsals.size(), 4u);
  again.segments.front().direction =
      StrainRate{Eigen::Matrix3d(again.segments.front().direction.tensor(std::array{2, 0, 1}, std::array{2, 0, 1}))};
  EXPECT_EQ(spokesmen_for(resolve(again), paths).rehearsals.size(), 4u) << "nor with other names of the axes";
  again.nu += 4e-3;
  EXPECT_EQ(spokesmen_for(resolve(again), paths).rehearsals.size(), 5u);
}

TEST(Rehearsals, SaysInWhichWaysAPathIsOutside) {
  const std::vector<Rehearsal> paths = monotone({0.03, 0.04, 0.05, 0.06});  // .70 to .73
  const auto ways = [&](std::vector<PathSegment> legs, double nu) {
    const auto path = path_from(nu, std::move(legs));
    return ways_outside(traits_of(path), spokesmen_for(path, paths));
  };
  EXPECT_TRUE(ways({leg(Mode::D2, 0.2)}, 0.715).empty());
  ASSERT_EQ(ways({leg(Mode::D2, 0.2)}, 0.69).size(), 1u);
  EXPECT_EQ(ways({leg(Mode::D2, 0.2)}, 0.69)[0], "nu down to 0.69 (rehearsed: 0.7)");
  EXPECT_EQ(ways({leg(Mode::D2, 0.3)}, 0.71).size(), 2u) << "strain and shear path";
  ASSERT_EQ(ways({leg(Mode::D3, 0.1)}, 0.71).size(), 1u);
  EXPECT_NE(ways({leg(Mode::D3, 0.1)}, 0.71)[0].find("cos(3 theta)"), std::string::npos);
  EXPECT_EQ(ways({leg(Mode::D2, 0.05), leg(Mode::D2, 0.05, true)}, 0.71).size(), 2u) << "a turn, a reversal";
  EXPECT_TRUE(ways_outside(traits_of(path_from(0.71, {leg(Mode::D2, 0.1)})), {}).empty()) << "nothing to be outside of";
}

TEST(Rehearsals, ScoresAreRelativeToTheBestInEachQuantity) {
  std::vector<Rehearsal> paths;
  for (const double nu : {0.70, 0.71}) {
    Rehearsal& r = paths.emplace_back(
        rehearsal(path_of(nu, {leg(Mode::D2, 0.2)}), {{Rung::reduced, 0.2}, {Rung::evolution, 0.1}}));
    r.rungs[0].F_par.square = 0.0025;  // reduced: half of evolution's
  }
  const auto table =
      scores(spokesmen_for(path_from(0.8, {leg(Mode::D2, 0.2)}), paths), {Rung::reduced, Rung::evolution});
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[0].rung, Rung::evolution);
  EXPECT_NEAR(table[0].score, std::sqrt((1 + 1 + 4) / 3.0), 1e-12);
  EXPECT_NEAR(table[1].score, std::sqrt((4 + 4 + 1) / 3.0), 1e-12);
  EXPECT_TRUE(scores(spokesmen_for(path_from(0.8, {leg(Mode::D2, 0.2)}), paths), {Rung::memory}).empty());
}

TEST(Rehearsals, NoiseOfATableIsNoTurnAndNoExpansion) {
  const auto traits = [](const Eigen::Matrix3d& D, ExtentKind kind = ExtentKind::eps_dev) {
    return traits_of(path_from(0.75, {leg(Mode::D3, 0.2), {Mode::tensor, {D}, kind, 0.05}}));
  };
  const PathTraits pure = traits(-Eigen::Matrix3d::Identity(), ExtentKind::eps_vol);
  for (const double noise : {1e-8, -1e-8, 1e-5, -1e-5}) {
    Eigen::Matrix3d D = -Eigen::Matrix3d::Identity();
    D.diagonal() += noise * Eigen::Vector3d(1, -2, 1);
    const PathTraits noisy = traits(D, ExtentKind::eps_vol);
    EXPECT_EQ(noisy.turns, pure.turns) << noise;
    EXPECT_EQ(noisy.reversals, pure.reversals) << noise;
    EXPECT_EQ(noisy.lode_min, pure.lode_min) << noise;
    Eigen::Matrix3d shear = Eigen::Vector3d(0.5, 0.5, -1).asDiagonal();
    shear += noise * Eigen::Matrix3d::Identity();
    EXPECT_FALSE(traits(shear).expands) << noise;
  }
  Eigen::Matrix3d expands = Eigen::Vector3d(1, 0, -0.9).asDiagonal();
  EXPECT_TRUE(traits(expands).expands);
  EXPECT_TRUE(traits(1e-10 * expands).expands) << "whatever the unit of its rates";
}

}  // namespace
}  // namespace grainlaw
