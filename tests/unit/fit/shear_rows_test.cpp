#include "fit/data/shear_rows.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace grainlaw::fit {
namespace {

std::vector<double> strains(double to, int rows) {
  std::vector<double> e;
  for (int i = 0; i <= rows; ++i) e.push_back(to * i / rows);
  return e;
}

double weight_in(const RowWeights& rows, const std::vector<double>& e, double from, double to) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.row.size(); ++i) {
    if (e[rows.row[i]] >= from && e[rows.row[i]] <= to) sum += rows.weight[i] * rows.weight[i];
  }
  return sum;
}

TEST(ShearWindow, WeightOfAWindowDoesNotDependOnTheLengthOfTheTest) {
  for (const double to : {0.3, 1.0}) {
    const std::vector<double> e = strains(to, 400);
    const RowWeights rows = shear_window(e, {});  // steady_weight 3, squared in the cost
    EXPECT_NEAR(weight_in(rows, e, 0, 0.1201), 1, 1e-12) << to;
    EXPECT_NEAR(weight_in(rows, e, 0.1499, to), 9, 1e-12) << to;
    EXPECT_EQ(weight_in(rows, e, 0.1201, 0.1499), 0) << to;
  }
}

TEST(ShearWindow, StartIsNoDatumAndTheWindowsHaveTheirEnds) {
  const std::vector<double> e{0, 0.12, 0.13, 0.15};
  const RowWeights rows = shear_window(e, {});
  EXPECT_EQ(rows.row, (std::vector<std::size_t>{1, 3}));
}

TEST(ShearWindow, FewRowsDoNotWeighLikeAFullWindow) {
  const RowWeights rows = shear_window({0, 0.05, 0.2}, {});
  ASSERT_EQ(rows.weight.size(), 2u);
  EXPECT_NEAR(rows.weight[0] * rows.weight[0], 1.0 / kFullWindow, 1e-15);
}

TEST(ShearWindow, WholeWindowTakesAllButTheStart) {
  const RowWeights rows = whole_window(strains(0.05, 40));
  EXPECT_EQ(rows.row.size(), 40u);
  EXPECT_NEAR(std::inner_product(rows.weight.begin(), rows.weight.end(), rows.weight.begin(), 0.0), 1, 1e-12);
}

}  // namespace
}  // namespace grainlaw::fit
