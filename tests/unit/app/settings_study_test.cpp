#include "app/settings_study.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::app {
namespace {

/// Data of three packings whose fabric is `factor` times the published, times (1 + scatter * seed's number).
Dataset dataset(double factor, double scatter) {
  Dataset all;
  testing::SyntheticOptions options;
  options.densities = {0.70, 0.78};
  options.sequences = false;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    LawParameters<double> law = testing::synthetic_truth();
    law.fabric_max.Q_c *= factor * (1 + scatter * (static_cast<double>(seed) - 2));
    options.seeds = {seed};
    for (TestRecord& record : testing::SyntheticDataset(law, options).records()) {
      record.packing.particles = 100;
      all.tests.push_back({record, "", "", {10, 1e-8, 2.5}, {}});
    }
    all.seeds.push_back(seed);
  }
  return all;
}

TEST(SettingsStudy, ErrorsAreMeansOverPackingsOfPairedDifferences) {
  const SettingResult r = compare_setting({"tenth", {}, {}}, dataset(1.1, 0.02), dataset(1, 0));
  for (const QuantityError& e : r.errors) {
    const bool fabric = e.quantity.starts_with("F_max");
    EXPECT_NEAR(e.error, fabric ? 0.1 : 0, 2e-3) << e.quantity;
    // packings deviate by -.022, 0, +.022
    EXPECT_NEAR(e.standard_error, fabric ? 0.022 / std::sqrt(3.0) : 0, 1e-3) << e.quantity;
  }
  ASSERT_EQ(r.errors.size(), 13u);
  EXPECT_NEAR(r.error, 0.1 / std::sqrt(6.0), 1e-3);  // two of twelve quantities
  EXPECT_EQ(r.particle_steps, 9 * 10 * 100);         // ISO and two D2 for each of three packings
  EXPECT_DOUBLE_EQ(r.seconds, 9 * 2.5);
  EXPECT_EQ(compare_setting({"same", {}, {}}, dataset(1, 0), dataset(1, 0)).error, 0);
}

TEST(SettingsStudy, ASettingIsDominatedByACheaperOneThatIsNotWorse) {
  const auto result = [](double cost, double error, double floor) {
    SettingResult r;
    r.particle_steps = cost;
    r.error = error;
    r.floor = floor;
    return r;
  };
  std::vector<SettingResult> all{result(99, 0, 0), result(4, 0.02, 0.01), result(3, 0.03, 0.01), result(5, 0.025, 0.01),
                                 result(2, 0.001, 0.025)};
  find_dominated(all);
  // the last one's error is below its floor, which then counts
  const std::vector<bool> expected{false, false, true, true, false};
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].dominated, expected[i]) << i;
}

TEST(SettingsStudy, ChangesAreKeysOfTheSpec) {
  EXPECT_EQ(change_from("strain_rate=69").second, Json(69));
  EXPECT_EQ(change_from("precision=double").second, Json("double"));
  for (const char* bad : {"strain_rate", "=3", "strain_rate="}) EXPECT_THROW(change_from(bad), InvalidInput) << bad;
  EXPECT_EQ(
      setting_of("x", spec_from_json(Json::object(), "x"), {{"particles", 500}}).spec.preparation.packing.particles,
      500);
  EXPECT_THROW(setting_of("x", spec_from_json(Json::object(), "x"), {{"particle", 500}}), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::app
