#include "app/report/first_screen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/report/tables.hpp"
#include "app/report/warning_groups.hpp"
#include "tests/support/report_scene.hpp"

namespace grainlaw::app::report {
namespace {

using chain::PathError;

PathError path_of_kind(PathKind kind, std::array<double, 3> error, const std::string& name) {
  PathError entry;
  entry.path = name;
  entry.kind = kind;
  entry.recommended = true;
  entry.error = error;
  return entry;
}

std::string words_of(const std::vector<PathError>& errors) {
  return to_plain(verdict(test::report_scene(), errors).text);
}

bool says(const std::vector<Reservation>& all, const std::string& words, std::size_t within = 3) {
  return std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(within, all.size())),
                     [&](const Reservation& r) { return r.words.find(words) != std::string::npos; });
}

TEST(ReportFirstScreen, TheVerdictFollowsFromTheErrorsByTheStatedLimits) {
  const PathError good = path_of_kind(PathKind::monotone, {0.01, 0.1, 0.1}, "a"),
                  rough = path_of_kind(PathKind::cyclic, {0.01, 0.11, 0.25}, "b"),
                  poor = path_of_kind(PathKind::unloading, {0.02, 0.26, 0.05}, "c");
  EXPECT_EQ(verdict(test::report_scene(), {good}).tone, Tone::good);
  EXPECT_EQ(verdict(test::report_scene(), {good, rough}).tone, Tone::fair);
  EXPECT_EQ(verdict(test::report_scene(), {good, rough, poor}).tone, Tone::poor);
  const std::string words = words_of({good, rough, poor});
  EXPECT_TRUE(words.starts_with("Usable in part: ")) << words;
  EXPECT_NE(words.find("pressure good;"), std::string::npos) << words;
  EXPECT_NE(words.find("stress ratio good, rough on cyclic paths, poor on unloading paths;"), std::string::npos)
      << words;
  EXPECT_NE(words.find("fabric good, rough on cyclic paths."), std::string::npos) << words;
  EXPECT_TRUE(words_of({good}).starts_with("Usable as it is, on monotone paths: ")) << words_of({good});
  EXPECT_NE(words_of({}).find("Not judged"), std::string::npos);
  chain::ReportInput diverged = test::report_scene();
  diverged.calibration.law.converged = false;
  EXPECT_EQ(verdict(diverged, {good}).tone, Tone::poor) << "however good it looks";
}

TEST(ReportFirstScreen, ARungThatIsNotRecommendedDoesNotCount) {
  PathError other = path_of_kind(PathKind::monotone, {0.5, 0.5, 0.5}, "a");
  other.recommended = false;
  const PathError good = path_of_kind(PathKind::monotone, {0.01, 0.01, 0.01}, "a");
  EXPECT_EQ(verdict(test::report_scene(), {other, good}).tone, Tone::good);
  const Table kinds = errors_by_kind({other, good});
  ASSERT_EQ(kinds.rows.size(), 1U);
  EXPECT_NEAR(kinds.rows[0][2].value, 1, 1e-12);
  EXPECT_EQ(kinds.rows[0][2].heat, 0);
}

TEST(ReportFirstScreen, PredictedPathsAreNotHiddenBehindManyRehearsals) {
  const predict::PredictionFolder folder;
  std::vector<PathError> errors(20, path_of_kind(PathKind::monotone, {0.01, 0.01, 0.01}, "rehearsed"));
  EXPECT_EQ(verdict(test::report_scene(), errors).tone, Tone::good);
  errors.push_back(path_of_kind(PathKind::monotone, {0.01, 0.01, 0.3}, "predicted"));
  errors.back().prediction = &folder;
  EXPECT_EQ(verdict(test::report_scene(), errors).tone, Tone::poor);
}

TEST(ReportFirstScreen, WhatIsWorstIsSaidFirst) {
  chain::ReportInput input = test::report_scene();
  input.calibration.law.rehearsals.resize(1);  // as if one was there
  const std::vector<PathError> good(1, path_of_kind(PathKind::monotone, {0.01, 0.02, 0.03}, "fine"));
  EXPECT_FALSE(says(reservations(input, good), "not converged"));
  EXPECT_TRUE(says(reservations(input, good), "2 packings")) << "the scene has two";
  std::vector<PathError> bad = good;
  bad.push_back(path_of_kind(PathKind::cyclic, {0.01, 0.4, 0.03}, "far"));
  bad.back().in_band = {0.99, 0.5, 0.97};
  const std::vector<Reservation> all = reservations(input, bad);
  EXPECT_TRUE(says(all, "stress ratio along far (cyclic) is 40.0 % off"));
  EXPECT_TRUE(says(all, "holds 50 % of the rows of stress ratio along far"));
  EXPECT_TRUE(says(all, "Never tried: unloading and turning", 10));
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](auto& a, auto& b) { return a.weight > b.weight; }));
  Rehearsal& rehearsal = input.calibration.law.rehearsals.front();
  rehearsal.rungs = {{Rung::reduced, {90, 1e-4, 0, 0.02}, {90, 1e-4, 0, 0.02}, {90, 1e-4, 0, 0.02}}};
  EXPECT_TRUE(says(reservations(input, good), "1 of 1 rehearsals ran on packings whose other tests were fitted"));
  rehearsal.rungs.front().P_star.known = 1e-6;
  EXPECT_FALSE(says(reservations(input, good), "whose other tests were fitted", 100));
  input.calibration.law.converged = false;
  input.calibration.stages.back().converged = false;
  EXPECT_TRUE(says(reservations(input, bad), "Not converged: evolution", 1));
  input.calibration.law.rehearsals.clear();
  EXPECT_TRUE(says(reservations(input, good), "no path was rehearsed"));
  EXPECT_TRUE(says(reservations(input, {}), "Nothing is known of its error"));
}

TEST(ReportFirstScreen, ShadesGoByTheLimits) {
  EXPECT_EQ(heat_of(0), 0);
  EXPECT_EQ(heat_of(0.025), 0);
  EXPECT_EQ(heat_of(0.0251), 1);
  EXPECT_EQ(heat_of(kGood), 2);
  EXPECT_EQ(heat_of(kRough), 3);
  EXPECT_EQ(heat_of(7), kHeats - 1);
  EXPECT_EQ(heat_of(PathError::kNone), -1);
}

const WarningGroup* group_of(const std::vector<WarningGroup>& groups, const std::string& cause) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const WarningGroup& g) { return g.cause.find(cause) != std::string::npos; });
  return found == groups.end() ? nullptr : &*found;
}

TEST(ReportWarnings, OneCauseIsOneRowWithWhatItCosts) {
  chain::ReportInput input = test::report_scene();
  input.predictions.clear();
  for (TestRecord& test : input.tests) {
    for (Observation& row : test.rows) row.inertial_number = 1e-4;
  }
  input.run_warnings = {"D2-1: energy residual above 0.001 in 4 of 121 rows, up to 0.0015 at nu = 0.7200",
                        "D2-2: energy residual above 0.001 in 3 of 121 rows, up to 0.0025 at nu = 0.7600",
                        "D2-2: energy residual above 0.001 in 3 of 121 rows, up to 0.0025 at nu = 0.7600",
                        "D2-3: something that nobody has seen before"};
  input.calibration.warnings = {"packings of 2000 spheres: small"};
  const std::vector<WarningGroup> groups = warning_groups(input);
  ASSERT_EQ(groups.size(), 3U);
  const WarningGroup* energy = group_of(groups, "energy balance");
  ASSERT_NE(energy, nullptr);
  EXPECT_EQ(energy->where, (std::vector<std::string>{"D2-1", "D2-2"})) << "each once";
  EXPECT_NE(energy->example.find("0.0025"), std::string::npos) << "the worst";
  EXPECT_NE(energy->consequence.find("time_step_fraction"), std::string::npos);
  EXPECT_NE(group_of(groups, "nobody has seen"), nullptr);
  const Table table = warning_table(groups);
  ASSERT_EQ(table.notes.size(), table.rows.size());
}

TEST(ReportWarnings, CausesAreNotMistakenForOneAnother) {
  chain::ReportInput input = test::report_scene();
  input.predictions.resize(1);
  input.predictions[0].warnings = {
      "the law was calibrated without fabric: it says nothing of it",
      "the path spins, which nothing that was calibrated or rehearsed does; how far the law is off there is not known",
      "runs are on packings that were fitted, too (seeds 1): they agree better than new ones would"};
  input.predictions[0].curves.front().prediction.warnings = {
      "nu = 0.9 lies outside the calibrated range 0.67-0.82"};
  input.predictions[0].failures = {{Rung::memory, predict::Initial::law, {}, "the run tells no fabric"}};
  const std::vector<WarningGroup> groups = warning_groups(input);
  for (const char* cause : {"no fabric in the data", "paths with spin", "runs on packings that were fitted",
                            "paths beyond the calibrated range", "curves that are left out"})
    EXPECT_NE(group_of(groups, cause), nullptr) << cause;
}

TEST(ReportWarnings, InertiaIsCountedWhereThePackingIsJammed) {
  chain::ReportInput input = test::report_scene();
  input.predictions.clear();
  input.run_warnings = {"ISO: inertial number above 0.001 in 21 of 121 rows, up to 2.26 at nu = 0.6453"};
  for (TestRecord& test : input.tests) {
    for (Observation& row : test.rows) row.C_star = 5.9, row.inertial_number = 1;
  }
  EXPECT_TRUE(warning_groups(input).empty()) << "all of it is below jamming";
  input.tests.front().rows[3].C_star = 6.1;
  const std::vector<WarningGroup> groups = warning_groups(input);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].where, std::vector<std::string>{input.tests.front().name});
  EXPECT_NE(groups[0].example.find("1 of"), std::string::npos) << groups[0].example;
}

TEST(ReportComparison, DifferencesCountInUnitsOfTheirError) {
  const CalibratedLaw ours = test::report_scene().calibration.law;
  CalibratedLaw other = ours;
  const std::size_t i = parameter_index("pressure.p0");
  other.estimates[i].value = ours.estimates[i].value - 5 * ours.estimates[i].standard_error;
  const Table table = parameter_pairs(ours, other);
  const auto row = std::find_if(table.rows.begin(), table.rows.end(),
                                [](const auto& cells) { return to_plain(cells[0].text) == "pressure.p0"; });
  ASSERT_NE(row, table.rows.end());
  EXPECT_NEAR((*row)[3].value, 5 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(table.caption.substr(0, 2), "1 ");
}

TEST(ReportComparison, ErrorsStandBesideEachOtherWhereBothHaveThePath) {
  const chain::ReportInput input = test::report_scene();
  std::vector<PathError> ours = errors_on_unseen_paths(input), other = ours;
  other.erase(other.begin(), other.begin() + 2);  // the first path
  for (PathError& entry : other) entry.error = {0.3, 0.2, 0.1};
  const Table table = error_pairs(ours, other);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(to_plain(table.rows[0][0].text), "uniaxial-0.728");
  EXPECT_NEAR(table.rows[0][3].value, 2.8, 1e-12);
  EXPECT_NEAR(table.rows[0][4].value, 30, 1e-12);
}

TEST(ReportFirstScreen, WithoutANumberThereIsNoVerdict) {
  const PathError nothing =
      path_of_kind(PathKind::monotone, {PathError::kNone, PathError::kNone, PathError::kNone}, "a");
  EXPECT_EQ(verdict(test::report_scene(), {}).tone, Tone::poor);
  PathError other = path_of_kind(PathKind::monotone, {0.01, 0.01, 0.01}, "a");
  other.recommended = false;
  EXPECT_EQ(verdict(test::report_scene(), {other}).tone, Tone::poor);
  EXPECT_NE(words_of({path_of_kind(PathKind::monotone, {0.01, 0.01, PathError::kNone}, "a")}).find("of fabric nothing"),
            std::string::npos);
  chain::ReportInput input = test::report_scene();
  for (predict::PredictionFolder& prediction : input.predictions) {
    for (predict::CurveComparison& mean : prediction.comparisons) {
      for (auto& q : mean.comparison.quantities) q.normalised_rms = PathError::kNone;
    }
  }
  input.calibration.law.rehearsals.clear();
  EXPECT_TRUE(errors_on_unseen_paths(input).empty());
}

TEST(ReportComparison, WhatHasNoErrorIsNotSoAndSoManyOfNoneAway) {
  const CalibratedLaw ours = test::report_scene().calibration.law;
  CalibratedLaw other = ours;
  Estimate& bound = other.estimates[parameter_index("pressure.p0")];
  bound = {9, std::nan(""), Status::at_bound, ""};
  const Table table = parameter_pairs(ours, other);
  const auto row =
      std::ranges::find_if(table.rows, [](auto& cells) { return to_plain(cells[0].text) == "pressure.p0"; });
  ASSERT_NE(row, table.rows.end());
  EXPECT_TRUE(std::isnan((*row)[3].value));
  EXPECT_NE(to_plain((*row)[2].text).find("at bound"), std::string::npos);
  EXPECT_EQ(table.caption.substr(0, 2), "0 ");
}

}  // namespace
}  // namespace grainlaw::app::report
