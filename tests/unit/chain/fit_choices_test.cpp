#include "chain/studies/fit_choices.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "chain/studies/spec_settings.hpp"
#include "fit/data/data_set.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/study_dataset.hpp"

namespace grainlaw::chain {
namespace {

const FitChoice& everything() {
  static const FitChoice all{testing::study_dataset(1, 0, {{0.70, 0.74, 0.78}}), {}};
  return all;
}

FitChoice with(const std::string& change) { return chosen(everything(), {change_from(change)}); }

std::vector<TestRecord> records(const FitChoice& choice) {
  std::vector<TestRecord> all;
  for (const DatasetTest& test : choice.dataset.tests) all.push_back(test.record);
  return all;
}

TEST(FitChoices, ThinnedTestsKeepEveryKthRowAndTheirCorners) {
  const FitChoice thin = with("rows_every=7");
  ASSERT_EQ(thin.dataset.tests.size(), everything().dataset.tests.size());
  for (std::size_t t = 0; t < thin.dataset.tests.size(); ++t) {
    const TestRecord &few = thin.dataset.tests[t].record, &all = everything().dataset.tests[t].record;
    const std::size_t segments = all.path.segments.size(), per_segment = (all.rows.size() - 1) / segments;
    EXPECT_EQ(few.rows.size(), 1 + segments * (per_segment / 7 + 1)) << few.name;  // 120 is no multiple of 7
    EXPECT_EQ(few.rows.back().nu, all.rows.back().nu);
    EXPECT_EQ(few.rows[1].time, all.rows[7].time);
    for (std::size_t k = 1; k <= segments; ++k)
      EXPECT_EQ(few.rows[k * (per_segment / 7 + 1)].time, all.rows[k * per_segment].time) << few.name;
  }
  EXPECT_NO_THROW(fit::check_and_sort(records(thin)));
  EXPECT_EQ(cost_of(thin.dataset).particle_steps, cost_of(everything().dataset).particle_steps);
}

TEST(FitChoices, PackingsAreTheFirstBySeed) {
  EXPECT_EQ(packings_of(with("packings=2").dataset), (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(with("packings=3").dataset.tests.size(), everything().dataset.tests.size());
  EXPECT_NEAR(cost_of(with("packings=2").dataset).seconds, cost_of(everything().dataset).seconds * 2 / 3, 1e-9);
}

TEST(FitChoices, DensitiesAreLeftOutPathByPath) {
  const FitChoice choice = with("densities_every=2");
  for (const DatasetTest& test : choice.dataset.tests) EXPECT_NE(test.record.path.nu, 0.74) << test.record.name;
  EXPECT_EQ(choice.dataset.tests.size(), 3u * (1 + 2 + 2));  // ISO, D2, D2->ISO of each packing
}

TEST(FitChoices, ShorterShearCostsLess) {
  const FitChoice choice = with("shear_strain=0.5");
  for (std::size_t t = 0; t < choice.dataset.tests.size(); ++t) {
    const DatasetTest &shorter = choice.dataset.tests[t], &all = everything().dataset.tests[t];
    if (!is_pure_shear(all.record)) {
      EXPECT_EQ(shorter.record.rows.size(), all.record.rows.size());
      continue;
    }
    EXPECT_EQ(shorter.record.rows.size(), 61u);  // of 121, at equal strain steps
    EXPECT_NEAR(shorter.record.rows.back().eps_dev, all.record.rows.back().eps_dev / 2, 1e-9);
    EXPECT_EQ(shorter.cost.steps, 5u);
  }
  EXPECT_NO_THROW(fit::check_and_sort(records(choice)));
}

TEST(FitChoices, AreRefusedWithWhatToGive) {
  EXPECT_EQ(with("loss=huber").options.loss, fit::Loss::huber);
  for (const char* bad : {"loss=squares", "packings=4", "packings=1", "rows_every=1", "rows_every=2.5", "rows_every=a",
                          "shear_strain=1", "shear_strain=0", "densities_every=1", "rows=3"})
    EXPECT_THROW(with(bad), InvalidInput) << bad;
}

TEST(FitChoices, TheUsualOnesCanAllBeMade) {
  const std::vector<std::string> usual = usual_choices(everything().dataset);
  EXPECT_EQ(std::count(usual.begin(), usual.end(), "packings=2"), 1);
  EXPECT_EQ(std::count(usual.begin(), usual.end(), "densities_every=2"), 1);
  for (const std::string& change : usual) EXPECT_NO_THROW(with(change)) << change;
}

}  // namespace
}  // namespace grainlaw::chain
