#include "app/settings_study.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/student.hpp"
#include "tests/support/study_dataset.hpp"

namespace grainlaw::app {
namespace {

/// Two numbers, each off by `error` of 1 and known to `scatter` with packings of the given seeds.
SettingOutcome outcome(const std::string& name, double cost, double error, double scatter,
                       const std::vector<std::uint64_t>& seeds) {
  const auto n = static_cast<Eigen::Index>(seeds.size());
  const Eigen::MatrixXd psi = Eigen::MatrixXd::Constant(1, n, scatter / std::sqrt(static_cast<double>(n)));
  const auto number = [&](const char* q, double x) {
    return StudyQuantity{q, Eigen::VectorXd::Constant(1, x), psi, true};
  };
  return {name, {}, {cost, 0, 0}, seeds, {number("a", 1 + error), number("b", 1 - error)}, "", ""};
}

TEST(SettingsStudy, NoiseIsTheFloorOfGivenPackingsAndTheSamplingOfChosenOnes) {
  const SettingOutcome reference = outcome("reference", 9, 0, 0.03, {1, 2}),
                       setting = outcome("x", 1, 0.05, 0.04, {8, 9});
  for (const Packings packings : {Packings::given, Packings::chosen}) {
    const SettingResult r = compare_setting(setting, reference, packings);
    EXPECT_NEAR(r.error, 0.05, 1e-14);
    EXPECT_NEAR(r.floor, 0.05, 1e-14);  // of .03 and .04, other packings
    EXPECT_NEAR(r.sampling, student_95(1) * 0.04, 1e-12);
    // all of the error may be chance
    EXPECT_NEAR(r.reached, packings == Packings::given ? 0.05 : r.sampling, 1e-9);
  }
  const SettingResult paired = compare_setting(outcome("x", 1, 0.05, 0.04, {1, 2}), reference, Packings::chosen);
  EXPECT_NEAR(paired.floor, 0.01, 1e-14);
  EXPECT_NEAR(paired.reached, std::hypot(std::sqrt(0.0025 - 0.0001), paired.sampling), 1e-14);
}

TEST(SettingsStudy, ADefaultIsDominatedByWhatIsCheaperAndNotWorse) {
  const std::vector<std::uint64_t> seeds{1, 2};
  const auto study = [&](const SettingOutcome& other) {
    return study_of("dem", "", Packings::given, {},
                    {outcome("reference", 9, 0, 0, seeds), outcome("base", 4, 0.02, 0.01, seeds), other}, 1);
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(study(outcome("better", 3, 0.01, 0.01, seeds)).results[1].dominated_by, Names{"better"});
  EXPECT_EQ(study(outcome("as good", 3, 0.02, 0.01, seeds)).results[1].dominated_by, Names{"as good"});
  EXPECT_EQ(study(outcome("worse", 3, 0.03, 0.01, seeds)).results[1].dominated_by, Names{});
  EXPECT_EQ(study(outcome("as dear", 4, 0.01, 0.01, seeds)).results[1].dominated_by, Names{});
  EXPECT_EQ(study(outcome("dearer, worse", 5, 0.03, 0.01, seeds)).results[2].dominated_by, Names{"base"});
  // its error is below its floor, which then counts
  EXPECT_EQ(study(outcome("noisy", 3, 0.001, 0.025, seeds)).results[1].dominated_by, Names{});
  // a reference is no competitor
  EXPECT_TRUE(study(outcome("dear", 10, 0.03, 0.01, seeds)).results[0].dominated_by.empty());
}

TEST(SettingsStudy, WhatShowsLessDominatesNothing) {
  const std::vector<std::uint64_t> seeds{1, 2};
  SettingOutcome half = outcome("half", 1, 0.001, 0.001, seeds);
  half.quantities.pop_back();
  const auto base = outcome("base", 4, 0.02, 0.001, seeds), reference = outcome("reference", 9, 0, 0, seeds);
  const SettingsStudy study = study_of("dem", "", Packings::given, {}, {reference, base, half}, 1);
  EXPECT_NEAR(study.results[2].error, 0.001, 1e-14);
  EXPECT_TRUE(study.results[1].dominated_by.empty());
  half.quantities.clear();
  EXPECT_TRUE(std::isnan(compare_setting(half, reference, Packings::given).reached));
}

TEST(SettingsStudy, RunsAreCountedOnceAndCalibrationTestsOnly) {
  Dataset dataset = testing::study_dataset(1, 0);
  const std::size_t tests = dataset.tests.size();
  EXPECT_EQ(cost_of(dataset).particle_steps, static_cast<double>(tests) * 10 * 100);
  EXPECT_DOUBLE_EQ(cost_of(dataset).seconds, static_cast<double>(tests) * 2.5);
  dataset.tests[0].run = dataset.tests[1].run = "one run";
  dataset.tests[2].record.role = Role::validation;
  EXPECT_EQ(cost_of(dataset).particle_steps, static_cast<double>(tests - 2) * 10 * 100);
  std::erase_if(dataset.tests, [](const DatasetTest& test) { return test.record.packing.seed == 2; });
  EXPECT_EQ(packings_of(dataset), (std::vector<std::uint64_t>{1, 3}));
}

}  // namespace
}  // namespace grainlaw::app
