#include "chain/import/straight_path.hpp"

#include <cmath>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

PathSegment segment(Mode mode, const std::string& axes, bool reverse, ExtentKind kind, double extent) {
  return {mode, direction_of(mode, axes, reverse), kind, extent};
}

/// Rows at equal steps along the path, both ends of each segment among them, every component off by up to `noise`.
std::vector<Observation> rows_along(const Path& path, int per_segment, double noise = 0) {
  std::vector<Observation> rows;
  int n = 0;
  for (const StraightSegment& s : resolve(path)) {
    for (int i = rows.empty() ? 0 : 1; i <= per_segment; ++i) {
      Observation& row = rows.emplace_back();
      row.strain = s.strain(s.length * i / per_segment);
      row.nu = s.nu(s.length * i / per_segment);
      for (int k = 0; k < 3 && rows.size() > 1; ++k) row.strain.tensor(k, k) += noise * std::sin(7.1 * ++n);
    }
  }
  return rows;
}

const Path kTurning{0.7,
                    Branch::unloading,
                    {segment(Mode::D2, "yzx", false, ExtentKind::eps_dev, 0.1),
                     segment(Mode::ISO, "xyz", false, ExtentKind::eps_vol, 0.03),
                     segment(Mode::D2, "yzx", true, ExtentKind::eps_dev, 0.2),
                     segment(Mode::UNI, "xzy", false, ExtentKind::eps_dev, 0.05),
                     segment(Mode::D3, "zyx", false, ExtentKind::eps_dev, 0.1)}};

TEST(StraightPath, IsFoundAgain) {
  for (const double noise : {0.0, 3e-7, 2e-5}) {
    const auto found = found_segments(rows_along(kTurning, 40, noise), 1e-4);
    ASSERT_EQ(found.size(), kTurning.segments.size()) << noise;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const PathSegment& is = kTurning.segments[k];
      EXPECT_EQ(found[k].mode, is.mode) << k;
      EXPECT_EQ(found[k].direction.tensor, is.direction.tensor) << k;  // snapped to the mode, to the last bit
      EXPECT_NEAR(found[k].extent, is.extent, 1e-12 + 10 * noise) << k;
    }
  }
}

// Unloading and loading again lie on the line from the first to the last row.
TEST(StraightPath, TurnsOnOneLineAreFound) {
  const Path loop{0.7,
                  Branch::unloading,
                  {segment(Mode::D2, "xyz", false, ExtentKind::eps_dev, 0.1),
                   segment(Mode::D2, "xyz", true, ExtentKind::eps_dev, 0.04),
                   segment(Mode::D2, "xyz", false, ExtentKind::eps_dev, 0.15)}};
  const auto found = found_segments(rows_along(loop, 25, 1e-6), 1e-4);
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k].extent, loop.segments[k].extent, 1e-5);
}

TEST(StraightPath, KeepsTheVolumeOfAShearThatIsNoMode) {
  Eigen::Matrix3d D = Eigen::Vector3d(0.7, 0.2, -0.9).asDiagonal();
  D(0, 1) = D(1, 0) = 0.3;
  const Path path{0.7, Branch::unloading, {{Mode::tensor, {D / D.norm()}, ExtentKind::eps_dev, 0.2}}};
  const auto found = found_segments(rows_along(path, 30, 1e-6), 1e-4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].mode, Mode::tensor);
  EXPECT_LT(std::abs(found[0].direction.tensor.trace()), 1e-15);
  EXPECT_LT((found[0].direction.tensor - D / D.norm()).norm(), 1e-4);
}

TEST(StraightPath, IsNotStraightenedBeyondTheTolerance) {
  const Path path{
      0.7, Branch::unloading, {{Mode::tensor, {Eigen::Vector3d(1.01, 0, -1).asDiagonal()}, ExtentKind::eps_dev, 0.2}}};
  const auto found = found_segments(rows_along(path, 30), 1e-4);  // 1e-3 from D2 at its end
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].mode, Mode::tensor);
  EXPECT_GT(found[0].direction.tensor.trace(), 1e-3);
  EXPECT_EQ(found_segments(rows_along(path, 30), 1e-2)[0].mode, Mode::D2);  // where the user allows it
}

TEST(StraightPath, RowsAreMovedOntoTheirSegments) {
  auto rows = rows_along(kTurning, 40, 1e-5);
  const auto exact = rows_along(kTurning, 40);
  const Moved moved = move_onto(kTurning, 1e-4, rows);
  EXPECT_LE(moved.farthest, std::sqrt(3.0) * 1e-5);
  EXPECT_GT(moved.farthest, 1e-6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) {
      EXPECT_EQ(rows[i].segment, static_cast<int>((i - 1) / 40)) << i;
    }
    EXPECT_LE((rows[i].strain.tensor - exact[i].strain.tensor).norm(), 4e-5) << i;
    EXPECT_NEAR(rows[i].nu, 0.7 * std::exp(-rows[i].strain.tensor.trace()), 1e-12);
  }
}

TEST(StraightPath, CornersEndTheirSegment) {
  auto rows = rows_along(kTurning, 40);
  move_onto(kTurning, 1e-4, rows);
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_EQ(rows[i].segment, static_cast<int>((i - 1) / 40)) << i;
}

// What a text of six digits leaves of a corner: the row lies a little before it.
TEST(StraightPath, RowsJustBeforeACornerEndTheirSegment) {
  auto rows = rows_along(kTurning, 40);
  const std::vector<StraightSegment> segments = resolve(kTurning);
  for (std::size_t k = 0; k < segments.size(); ++k)
    rows[40 * (k + 1)].strain = segments[k].strain(segments[k].length * (1 - 2e-5));
  EXPECT_LT(move_onto(kTurning, 1e-4, rows).farthest, 1e-5);
  for (std::size_t k = 0; k < segments.size(); ++k)
    EXPECT_EQ(rows[40 * (k + 1)].strain.tensor, segments[k].strain(segments[k].length).tensor) << k;
}

// Cycles go over the same strains again and again: what tells them apart is the order of the rows.
TEST(StraightPath, CyclesAreToldApartWithoutRowsAtTheCorners) {
  Path cycles{0.7, Branch::unloading, {segment(Mode::D2, "xyz", false, ExtentKind::eps_dev, 0.05)}};
  for (int i = 0; i < 6; ++i) cycles.segments.push_back(segment(Mode::D2, "xyz", i % 2 == 0, ExtentKind::eps_dev, 0.1));
  auto rows = rows_along(cycles, 21);
  std::vector<int> expected;
  std::vector<Observation> without_corners;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && i % 21 == 0) continue;
    without_corners.push_back(rows[i]);
    expected.push_back(static_cast<int>(i / 21));
  }
  EXPECT_LE(move_onto(cycles, 1e-4, without_corners).farthest, 1e-12);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const bool first =
        i > 0 && expected[i] != expected[i - 1];  // at the strain of the last before: may belong to either
    if (!first) {
      EXPECT_EQ(without_corners[i].segment, expected[i]) << i;
    }
  }
}

TEST(StraightPath, RefusesStrainsThatSayNone) {
  std::vector<Observation> rows(5);
  EXPECT_NE(testing::refusal([&] { found_segments(rows, 1e-4); }).find("the strain never exceeds 0"),
            std::string::npos);
  rows.resize(4000);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].strain.tensor(0, 0) = 1e-2 * static_cast<double>(i % 2);
  EXPECT_NE(testing::refusal([&] { found_segments(rows, 1e-4); }).find("turn more than 1000 times"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::chain
