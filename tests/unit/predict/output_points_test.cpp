#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;
using testing::leg_to;

using testing::kNaN;

TEST(UniformPoints, CoverEachSegmentEndsIncluded) {
  const auto path = testing::path_from(0.70, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.73)});
  const auto points = uniform_points(path, 4);
  ASSERT_EQ(points.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(points[i].segment, i < 5 ? 0 : 1);
    EXPECT_NEAR(points[i].e, path[i / 5].length * static_cast<double>(i % 5) / 4, 1e-17);
  }
  EXPECT_EQ(points[4].e, path[0].length) << "exactly";
  EXPECT_THROW(uniform_points(path, 0), InvalidInput);
}

/// A test with rows at the quarters of each segment of D2 -> ISO -> UNI.
TestRecord record() {
  TestRecord test;
  test.name = "made-up";
  test.path = {0.70, Branch::unloading, {leg(Mode::D2, 0.15), leg_to(Mode::ISO, 0.73), leg(Mode::UNI, 0.02)}};
  const auto segments = resolve(test.path);
  double time = 0;
  for (const OutputPoint& point : uniform_points(segments, 4)) {
    const auto& segment = segments[static_cast<std::size_t>(point.segment)];
    Observation row;
    row.time = time++;
    row.segment = point.segment;
    row.strain = segment.strain(point.e);
    row.nu = segment.nu(point.e);
    test.rows.push_back(row);
  }
  return test;
}

/// The message with which the rows are refused; empty when they are accepted.
std::string refusal(const TestRecord& test) {
  try {
    points_of(test);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(PointsOf, FindsTheRowsOnTheirPath) {
  const TestRecord test = record();
  const auto expected = uniform_points(resolve(test.path), 4), points = points_of(test);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].segment, expected[i].segment);
    EXPECT_NEAR(points[i].e, expected[i].e, 1e-15);
  }
}

TEST(PointsOf, RoundingStaysOnThePath) {
  TestRecord test = record();
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    const double sign = i % 2 ? 1 : -1;
    test.rows[i].strain.tensor(2, 2) += sign * 2e-10;
    test.rows[i].strain.tensor(0, 1) -= sign * 2e-10;
  }
  const auto segments = resolve(test.path);
  const auto points = points_of(test);
  EXPECT_NO_THROW(predict(Rung::reduced, published_parameters(), Coupling::single, segments,
                          state_from_law(published_parameters(), 0.70), points, {}, {}, {}))
      << "whatever rounding did, the points lie in their segments";
}

TEST(PointsOf, RepeatedRowsAndNoRows) {
  TestRecord test = record();
  test.rows.insert(test.rows.begin() + 2, test.rows[2]);
  const auto points = points_of(test);
  ASSERT_EQ(points.size(), 16U);
  EXPECT_EQ(points[2].e, points[3].e);
  test.rows.clear();
  EXPECT_TRUE(points_of(test).empty());
}

TEST(PointsOf, NamesTheRowThatIsWrong) {
  const auto with = [](std::size_t row, auto&& change) {
    TestRecord test = record();
    change(test.rows[row]);
    return refusal(test);
  };
  const auto names = [](const std::string& message, std::size_t row) {
    return message.find("made-up: row " + std::to_string(row + 1) + ":") != std::string::npos;
  };
  EXPECT_EQ(refusal(record()), "");
  EXPECT_TRUE(names(with(3, [](Observation& o) { o.strain.tensor(0, 0) += 1e-6; }), 3)) << "off the path";
  EXPECT_TRUE(names(with(3, [](Observation& o) { o.strain.tensor(1, 2) = kNaN; }), 3));
  EXPECT_TRUE(names(with(4, [](Observation& o) { o.time = kNaN; }), 4));
  EXPECT_TRUE(names(with(4, [](Observation& o) { o.time = 2.5; }), 4)) << "before the row above";
  EXPECT_TRUE(names(with(6, [](Observation& o) { o.segment = 0; }), 6)) << "segment runs back";
  EXPECT_TRUE(names(with(6, [](Observation& o) { o.segment = 7; }), 6));
  EXPECT_TRUE(names(with(0, [](Observation& o) { o.segment = -1; }), 0));
  EXPECT_TRUE(names(with(7, [](Observation& o) { o.nu += 1e-5; }), 7)) << "another packing than the path's";
  EXPECT_TRUE(names(with(7, [](Observation& o) { o.nu = kNaN; }), 7));
}

TEST(PointsOf, RowsThatRunBackAreRefused) {
  TestRecord test = record();
  std::swap(test.rows[1].strain, test.rows[2].strain);
  EXPECT_NE(refusal(test).find("row 3"), std::string::npos);
}

TEST(PointsOf, RowsBeyondTheEndAreRefused) {
  TestRecord test = record();
  const auto last = resolve(test.path).back();
  test.rows.back().strain = last.strain(last.length + 1e-6);
  EXPECT_NE(refusal(test).find("row 15"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::predict
