#include "chain/studies/law_quantities.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/study_dataset.hpp"

namespace grainlaw::chain {
namespace {

TEST(PackingQuantities, AreMeansOfPackingsByThemselves) {
  // F_max of the three packings is 1.1 (0.98, 1, 1.02) times the published
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  const auto ours = packing_quantities(testing::study_dataset(1.1, 0.02), seeds);
  const auto published = packing_quantities(testing::study_dataset(1, 0), seeds);
  ASSERT_EQ(ours.size(), 13u);
  for (std::size_t q = 0; q < ours.size(); ++q) {
    const bool fabric = ours[q].name.starts_with("F_max");
    const double value = published[q].values(0);
    EXPECT_EQ(ours[q].name, published[q].name);
    EXPECT_NEAR(ours[q].values(0) / value, fabric ? 1.1 : 1, 2e-3) << ours[q].name;
    EXPECT_NEAR(ours[q].influence.norm() / value, fabric ? 0.022 / std::sqrt(3.0) : 0, 1e-3) << ours[q].name;
    EXPECT_NEAR(ours[q].influence.sum(), 0, 1e-12 * value) << ours[q].name;
    EXPECT_EQ(ours[q].in_error, ours[q].name != "nu_c");
  }
}

TEST(PackingQuantities, APackingThatDoesNotShowItIsLeftOut) {
  Dataset dataset = testing::study_dataset(1.1, 0.02);
  for (DatasetTest& test : dataset.tests) {
    if (test.record.packing.seed == 3 && is_pure_shear(test.record))
      std::erase_if(test.record.rows, [](const Observation& row) { return row.eps_dev > 0.005; });
  }
  const auto published = packing_quantities(testing::study_dataset(1, 0), {1, 2, 3});
  const auto three = packing_quantities(dataset, {1, 2, 3}), two = packing_quantities(dataset, {1, 3});
  for (std::size_t q = 0; q < three.size(); ++q) {
    if (!three[q].name.starts_with("F_max")) continue;
    const double value = published[q].values(0);
    EXPECT_NEAR(three[q].values(0) / value, 1.1 * 0.99, 2e-3) << three[q].name << " of packings .98 and 1";
    EXPECT_EQ(three[q].influence(0, 2), 0);
    EXPECT_NEAR(three[q].influence.norm() / value, 1.1 * 0.01, 1e-3);
    EXPECT_TRUE(std::isnan(two[q].values(0))) << "one packing has no scatter";
  }
}

}  // namespace
}  // namespace grainlaw::chain
