#include "model/law_state.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace grainlaw {
namespace {

/// 1, 2, 3 ... in the order of the vector.
LawState<double> counted() {
  LawState<double> y;
  as_vector(y).setLinSpaced(1, static_cast<double>(kStateSize));
  return y;
}

TEST(LawState, IsZeroUnlessGiven) { EXPECT_TRUE(as_vector(LawState<double>{}).isZero(0)); }

TEST(LawState, PartsLieInTheVectorInTheOrderOfTheTable) {
  const LawState<double> y = counted();
  std::vector<double> seen;
  std::vector<std::string> names;
  for_each_part(
      [&]<class Part>(const StatePart& part, const Part& of_y) {
        names.emplace_back(part.name);
        if constexpr (std::is_same_v<Part, double>)
          seen.push_back(of_y);
        else
          seen.insert(seen.end(), of_y.begin(), of_y.end());
      },
      y);
  ASSERT_EQ(seen.size(), kStateSize) << "every part has a line of the table";
  for (std::size_t i = 0; i < kStateSize; ++i) EXPECT_EQ(seen[i], static_cast<double>(i + 1));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << "no two of one name";
}

TEST(LawState, MovesAllOfItsParts) {
  const LawState<double> sum = moved(counted(), -3, counted());
  for (std::size_t i = 0; i < kStateSize; ++i)
    EXPECT_EQ(as_vector(sum)(static_cast<Eigen::Index>(i)), -2 * static_cast<double>(i + 1));
}

TEST(LawState, SpinTurnsEveryDeviatorAndNoNumber) {
  LawDirection direction;
  direction.spin = {0.3, -0.2, 0.5};
  const LawState<double> y = counted();
  LawState<double> rate;
  add_corotation(y, direction, rate);
  for_each_part(
      [&]<class Part>(const StatePart& part, const Part& of_y, const Part& of_rate) {
        if constexpr (std::is_same_v<Part, double>) {
          EXPECT_EQ(of_rate, 0) << part.name;
        } else {
          EXPECT_NEAR(of_y.dot(of_rate), 0, 1e-12 * of_y.squaredNorm()) << part.name << ": its norm stays";
          EXPECT_GT(of_rate.norm(), 0.1 * of_y.norm()) << part.name;
        }
      },
      y, rate);
}

TEST(LawState, CastKeepsTheNumbers) {
  const LawState<float> y = cast<float>(counted());
  EXPECT_EQ(as_vector(y), as_vector(counted()).cast<float>());
}

}  // namespace
}  // namespace grainlaw
