#include "chain/studies/settings_study.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dem/element_tests/element_run.hpp"
#include "model/student.hpp"
#include "tests/support/study_dataset.hpp"

namespace grainlaw::chain {
namespace {

/// Two numbers, each off by `error` of 1 and known to `scatter` with packings of the given seeds.
SettingOutcome outcome(const std::string& name, double cost, double error, double scatter,
                       const std::vector<std::uint64_t>& seeds) {
  const auto n = static_cast<Eigen::Index>(seeds.size());
  const Eigen::MatrixXd psi = Eigen::MatrixXd::Constant(1, n, scatter / std::sqrt(static_cast<double>(n)));
  const auto number = [&](const char* q, double x) {
    return StudyQuantity{q, Eigen::VectorXd::Constant(1, x), psi, true};
  };
  return {name, {}, {cost, 0, 0}, seeds, {number("a", 1 + error), number("b", 1 - error)}, {}, 0, "", ""};
}

TEST(SettingsStudy, WhatReachesAddsTheSamplingOfChosenPackings) {
  const SettingOutcome reference = outcome("reference", 9, 0, 0.03, {1, 2});
  const auto result = [&](const SettingOutcome& setting) {
    return study_of("chain", "", Packings::chosen, {}, {reference, setting}, 1).results[1];
  };
  const SettingResult r = result(outcome("x", 1, 0.05, 0.04, {8, 9}));
  EXPECT_NEAR(r.error, 0.05, 1e-14);
  EXPECT_NEAR(r.floor, 0.05, 1e-14);  // of .03 and .04, other packings
  EXPECT_NEAR(r.sampling, student_95(1) * 0.04, 1e-12);
  EXPECT_NEAR(r.reached, r.sampling, 1e-9) << "all of the error may be chance";
  EXPECT_TRUE(std::isnan(r.errors[0].chance));
  const SettingResult paired = result(outcome("x", 1, 0.05, 0.04, {1, 2}));
  EXPECT_NEAR(paired.floor, 0.01, 1e-14);
  EXPECT_NEAR(paired.reached, std::hypot(std::sqrt(0.0025 - 0.0001), paired.noise), 1e-14);
}

/// `a` known to .01, `b` to .1; two standard errors off in one of them.
SettingOutcome unequal(const std::string& name, double cost, double off_a, double off_b,
                       const std::vector<std::uint64_t>& seeds) {
  const auto n = static_cast<double>(seeds.size());
  const auto number = [&](const char* q, double x, double scatter) {
    return StudyQuantity{q, Eigen::VectorXd::Constant(1, x),
                         Eigen::MatrixXd::Constant(1, static_cast<Eigen::Index>(seeds.size()), scatter / std::sqrt(n)),
                         true};
  };
  return {name, {}, {cost, 0, 0}, seeds, {number("a", 1 + off_a, 0.01), number("b", 1 + off_b, 0.1)}, {}, 0, "", ""};
}

// Of given packings what is known to 1 % counts as much as what is known to 10.
TEST(SettingsStudy, ErrorsOfGivenPackingsAreInUnitsOfTheirChance) {
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  const SettingOutcome reference = outcome("reference", 9, 0, 0, seeds);
  const SettingsStudy study = study_of("dem", "", Packings::given, {},
                                       {reference, unequal("base", 4, 0, 0, seeds), unequal("a off", 3, 0.03, 0, seeds),
                                        unequal("b off", 2, 0, 0.3, seeds)},
                                       1);
  for (const SettingResult& r : {study.results[2], study.results[3]}) {
    EXPECT_NEAR(r.errors[0].chance, 0.01, 1e-14);
    EXPECT_NEAR(r.errors[1].chance, 0.1, 1e-14);
    EXPECT_NEAR(r.error, std::sqrt((9 + 0) / 2.0), 1e-12) << r.outcome.name;
    EXPECT_EQ(r.floor, 1);
    EXPECT_EQ(r.noise, 1);
    EXPECT_NEAR(r.reached, r.error, 1e-12) << r.outcome.name;
  }
  EXPECT_NEAR(study.results[1].reached, 1, 1e-14) << "no error is seen below chance";
  EXPECT_TRUE(study.results[1].perhaps_dominated_by.empty());
}

// The chance is that of all settings which only compute otherwise: sqrt((.02^2 + .04^2)/2).
TEST(SettingsStudy, GivenPackingsShareTheirChance) {
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  SettingOutcome coarse = outcome("coarse", 1, 0.06, 0.04, seeds), silent = coarse;
  coarse.changes = {{"time_step_fraction", 0.2}};
  silent.quantities.pop_back();
  const SettingsStudy study =
      study_of("dem", "", Packings::given, {},
               {outcome("reference", 9, 0, 0, seeds), outcome("base", 2, 0.06, 0.02, seeds), coarse, silent}, 1);
  const double of_a = std::sqrt((0.0004 + 0.0016 + 0.0016) / 3), of_b = std::sqrt((0.0004 + 0.0016) / 2);
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_NEAR(study.results[i].errors[0].chance, of_a, 1e-14);
    EXPECT_NEAR(study.results[i].errors[1].chance, of_b, 1e-14);
    EXPECT_NEAR(study.results[i].error, 0.06 * std::sqrt((1 / (of_a * of_a) + 1 / (of_b * of_b)) / 2), 1e-12);
  }
  EXPECT_NEAR(study.results[3].error, 0.06 / of_a, 1e-12) << "of what it shows";
}

// How far packings lie apart is theirs, not the time step's: sqrt((.02^2 + .04^2)/2) of both, t standard errors each.
TEST(SettingsStudy, SettingsThatOnlyComputeOtherwiseShareTheirSampling) {
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  const SettingOutcome reference = outcome("reference", 9, 0, 0.03, {1, 2, 3, 4});
  SettingOutcome coarse = outcome("coarse", 1, 0, 0.04, seeds), fewer = outcome("fewer", 1, 0, 0.09, seeds);
  coarse.changes = {{"time_step_fraction", 0.2}};
  fewer.changes = {{"densities", {0.7, 0.8}}};
  SettingOutcome other = coarse;
  other.model = "reduced";
  const SettingsStudy study = study_of("chain", "", Packings::chosen, {},
                                       {reference, outcome("base", 2, 0, 0.02, seeds), coarse, fewer, other}, 1);
  const double t = student_95(2), pooled = t * std::sqrt((0.0004 + 0.0016) / 2);
  EXPECT_NEAR(study.results[1].noise, pooled, 1e-12);
  EXPECT_NEAR(study.results[2].noise, pooled, 1e-12);
  EXPECT_NEAR(study.results[2].sampling, t * 0.04, 1e-12) << "its own stays";
  EXPECT_NEAR(study.results[3].noise, t * 0.09, 1e-12) << "other tests";
  EXPECT_NEAR(study.results[4].noise, t * 0.04, 1e-12) << "another model";
  EXPECT_NEAR(study.results[0].noise, student_95(3) * 0.03, 1e-12) << "other packings";
}

TEST(SettingsStudy, ADefaultIsDominatedByWhatCostsNoMoreAndIsBetter) {
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  const auto study = [&](const SettingOutcome& other) {
    return study_of("dem", "", Packings::given, {},
                    {outcome("reference", 9, 0, 0, seeds), outcome("base", 4, 0.02, 0.001, seeds), other}, 1);
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(study(outcome("better", 3, 0.01, 0.001, seeds)).results[1].dominated_by, Names{"better"});
  EXPECT_EQ(study(outcome("as good", 3, 0.02, 0.001, seeds)).results[1].perhaps_dominated_by, Names{"as good"});
  EXPECT_EQ(study(outcome("worse", 3, 0.03, 0.001, seeds)).results[1].dominated_by, Names{});
  EXPECT_EQ(study(outcome("as dear", 4, 0.01, 0.001, seeds)).results[1].dominated_by, Names{"as dear"});
  EXPECT_EQ(study(outcome("as dear", 4, 0.01, 0.001, seeds)).results[2].dominated_by, Names{});
  EXPECT_EQ(study(outcome("dearer", 5, 0.01, 0.001, seeds)).results[1].dominated_by, Names{});
  // of two that cost the same and are the same within chance, neither is named
  const SettingsStudy alike = study(outcome("alike", 4, 0.0199, 0.001, seeds));
  EXPECT_LT(alike.results[2].reached, alike.results[1].reached);
  EXPECT_EQ(alike.results[1].dominated_by, Names{});
  EXPECT_EQ(alike.results[1].perhaps_dominated_by, Names{});
  const SettingsStudy same = study(outcome("the same", 4, 0.02, 0.001, seeds));
  EXPECT_EQ(same.results[1].perhaps_dominated_by, Names{});
  EXPECT_EQ(same.results[2].perhaps_dominated_by, Names{});
  EXPECT_EQ(same.results[1].dominated_by, Names{});
  EXPECT_EQ(same.results[2].dominated_by, Names{});
  // nor where there is no chance at all, as of the reference's own settings by another name; unless one is cheaper
  const auto certain = [&](double cost) {
    return study_of("dem", "", Packings::chosen, {},
                    {outcome("reference", 4, 0, 0, seeds), outcome("twin", cost, 0, 0, seeds)}, 0);
  };
  EXPECT_EQ(certain(4).results[0].dominated_by, Names{});
  EXPECT_EQ(certain(4).results[1].dominated_by, Names{});
  EXPECT_EQ(certain(3).results[0].dominated_by, Names{"twin"});
  EXPECT_EQ(study(outcome("dearer, worse", 5, 0.03, 0.001, seeds)).results[2].dominated_by, Names{"base"});
  // its error is below its floor, which then counts
  EXPECT_EQ(study(outcome("noisy", 3, 0.001, 0.025, seeds)).results[1].dominated_by, Names{});
  // a reference is no competitor
  EXPECT_TRUE(study(outcome("dear", 10, 0.03, 0.001, seeds)).results[0].dominated_by.empty());
}

// One packing of two: the whole reference is off by chance, its tests of the same packing are not.
TEST(SettingsStudy, ComparesWithTheReferenceByTheSamePackings) {
  SettingOutcome few = outcome("few", 1, 0.07, 0.04, {2, 3});
  few.compared_with = outcome("", 0, 0.05, 0.04, {2, 3}).quantities;
  const SettingResult r =
      study_of("chain", "", Packings::chosen, {}, {outcome("reference", 9, 0, 0.03, {1, 2, 3, 4}), few}, 1).results[1];
  EXPECT_NEAR(r.error, std::hypot(0.02 / 1.05, 0.02 / 0.95) / std::sqrt(2), 1e-14);
  EXPECT_NEAR(r.floor, 0, 1e-14) << "the packings moved both alike";
  EXPECT_NEAR(r.reached, std::hypot(r.error, r.sampling), 1e-14);
}

TEST(SettingsStudy, WhatMayBeStoppedDominatesNothingThatIsSafe) {
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  const double stop = dem::ElementTestOptions().stop_energy_residual;
  const auto dominates = [&](double of_base, double of_other) {
    SettingOutcome base = outcome("base", 4, 0.02, 0.001, seeds), other = outcome("other", 3, 0.01, 0.001, seeds);
    base.energy_residual = of_base;
    other.energy_residual = of_other;
    const SettingOutcome reference = outcome("reference", 9, 0, 0, seeds);
    return !study_of("dem", "", Packings::given, {}, {reference, base, other}, 1).results[1].dominated_by.empty();
  };
  EXPECT_TRUE(dominates(0.3 * stop, 0.49 * stop));
  EXPECT_FALSE(dominates(0.3 * stop, 0.51 * stop));
  EXPECT_TRUE(dominates(0.6 * stop, 0.9 * stop)) << "neither is safe";
}

TEST(SettingsStudy, WhatShowsLessDominatesNothing) {
  const std::vector<std::uint64_t> seeds{1, 2};
  SettingOutcome half = outcome("half", 1, 0.001, 0.001, seeds);
  half.quantities.pop_back();
  const auto base = outcome("base", 4, 0.02, 0.001, seeds), reference = outcome("reference", 9, 0, 0, seeds);
  const SettingsStudy study = study_of("dem", "", Packings::given, {}, {reference, base, half}, 1);
  EXPECT_NEAR(study.results[2].error, 1, 1e-12) << "in units of chance";
  EXPECT_TRUE(study.results[1].dominated_by.empty());
  half.quantities.clear();
  EXPECT_TRUE(std::isnan(study_of("dem", "", Packings::given, {}, {reference, half}, 1).results[1].reached));
}

/// One number, the mean of what each packing shows.
SettingOutcome of_packings(const std::string& name, double cost, const Eigen::RowVectorXd& x,
                           const std::vector<std::uint64_t>& seeds) {
  const auto n = static_cast<double>(x.size());
  const Eigen::MatrixXd psi = (x.array() - x.mean()).matrix() / std::sqrt(n * (n - 1));
  return {name, {}, {cost, 0, 0}, seeds, {{"a", Eigen::VectorXd::Constant(1, x.mean()), psi, true}}, {}, 0, "", ""};
}

TEST(SettingsStudy, LeavingAPackingOutIsExactForMeans) {
  const Eigen::RowVectorXd x{{1.02, 0.97, 1.05, 0.99}}, rest{{1.02, 0.97, 0.99}};
  const StudyQuantity all = of_packings("", 0, x, {1, 2, 3, 4}).quantities.front(),
                      expected = of_packings("", 0, rest, {1, 2, 4}).quantities.front(),
                      found = without_packing(all, 2);
  EXPECT_NEAR(found.values(0), expected.values(0), 1e-15);
  ASSERT_EQ(found.influence.cols(), 3);
  EXPECT_LT((found.influence - expected.influence).norm(), 1e-15);
  const StudyQuantity two = of_packings("", 0, rest.head(2), {1, 2}).quantities.front();
  EXPECT_TRUE(std::isnan(without_packing(two, 0).values(0))) << "one packing knows no scatter";
}

// The default is off by 2 %, the cheaper one by 1 %: with packings that agree on it that is so, with others it is a toss.
TEST(SettingsStudy, ADifferenceWithinChanceIsNoDomination) {
  const std::vector<std::uint64_t> seeds{1, 2, 3, 4};
  const Eigen::RowVectorXd reference = Eigen::RowVectorXd::Ones(4), scatter{{1, -1, 0.5, -0.5}};
  using Names = std::vector<std::string>;
  for (const double size : {0.0005, 0.02}) {
    const Eigen::RowVectorXd base = reference * 1.02 + size * scatter, cheap = reference * 1.01 - size * scatter;
    const SettingsStudy study = study_of("dem", "", Packings::given, {},
                                         {of_packings("reference", 9, reference, seeds),
                                          of_packings("base", 4, base, seeds), of_packings("cheap", 3, cheap, seeds)},
                                         1);
    const SettingResult& judged = study.results[1];
    EXPECT_EQ(judged.dominated_by, size < 0.01 ? Names{"cheap"} : Names{}) << size;
    EXPECT_EQ(judged.perhaps_dominated_by, size < 0.01 ? Names{} : Names{"cheap"}) << size;
    // the jackknife of |d| over its standard error, of which d is a mean
    EXPECT_NEAR(judged.reached_error, 1, size < 0.01 ? 1e-9 : 0.2) << size;
  }
  // An error below its floor says nothing: a coarser step with the same packings, off by nothing on the average, is no better than the
  // reference's own settings, whose error is none by definition.
  SettingOutcome base = of_packings("base", 4, reference + 0.02 * scatter, seeds),
                 coarse = of_packings("coarse", 3, reference + 0.02 * scatter.reverse(), seeds);
  coarse.changes = {{"time_step_fraction", 0.2}};
  SettingOutcome whole = base;
  whole.name = "reference";
  const SettingResult same = study_of("chain", "", Packings::chosen, {}, {whole, base, coarse}, 1).results[1];
  EXPECT_EQ(same.dominated_by, Names{});
  EXPECT_EQ(same.perhaps_dominated_by, Names{"coarse"});
  // two packings do not know
  const Eigen::RowVectorXd two = reference.head(2), scatter_of_two = 0.0005 * scatter.head(2);
  const SettingsStudy few =
      study_of("dem", "", Packings::given, {},
               {of_packings("reference", 9, two, {1, 2}), of_packings("base", 4, two * 1.02 + scatter_of_two, {1, 2}),
                of_packings("cheap", 3, two * 1.01 + scatter_of_two, {1, 2})},
               1);
  EXPECT_EQ(few.results[1].perhaps_dominated_by, Names{"cheap"});
  EXPECT_TRUE(std::isnan(few.results[1].reached_error));
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
}  // namespace grainlaw::chain
