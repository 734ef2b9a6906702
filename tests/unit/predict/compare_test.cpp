#include "predict/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/vocabulary/error.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;

using testing::kNaN;

/// A D2 test with rows at shear_path 0, 0.005, 0.01, 0.02, 0.04 whose observations are what is predicted there.
struct Scene {
  TestRecord test;
  Prediction prediction;
};

Scene scene(const std::vector<PathSegment>& path, const std::vector<OutputPoint>& points) {
  Scene s;
  s.test.name = "made-up";
  s.test.path = {0.74, Branch::unloading, path};
  const LawParameters<double> p = published_parameters();
  s.prediction =
      predict(Rung::reduced, p, Coupling::single, resolve(s.test.path), state_from_law(p, 0.74), points, {}, {}, {});
  for (const PredictedRow& row : s.prediction.rows) {
    Observation o;
    o.strain = row.strain;
    o.P_star = row.state.P;
    o.s_par = row.s_par;
    o.F_par = row.F_par;
    s.test.rows.push_back(o);
  }
  return s;
}

Scene scene(Mode mode = Mode::D2) {
  const std::vector<PathSegment> path{leg(mode, 0.04)};
  const double length = resolve({0.74, Branch::unloading, path})[0].length;
  return scene(path, {{0, 0.0}, {0, length / 8}, {0, length / 4}, {0, length / 2}, {0, length}});
}

const QuantityComparison& quantity(const Comparison& comparison, const std::string& name) {
  for (const auto& q : comparison.quantities) {
    if (q.quantity == name) return q;
  }
  throw Error("no " + name);
}

TEST(Compare, EqualSeriesDoNotDiffer) {
  const Scene s = scene();
  const Comparison comparison = compare(s.prediction, s.test);
  EXPECT_EQ(comparison.test, "made-up");
  ASSERT_EQ(comparison.quantities.size(), 3U);
  for (const auto& q : comparison.quantities) {
    EXPECT_EQ(q.rows, 3) << q.quantity << ": rows from shear_path = 0.01 on";
    EXPECT_EQ(q.bias, 0);
    EXPECT_EQ(q.rms, 0);
    EXPECT_EQ(q.normalised_rms, 0);
    EXPECT_EQ(q.largest, 0);
  }
}

TEST(Compare, BiasAndRmsAreThoseOfTheDefinition) {
  Scene s = scene();
  const double shift[] = {100, 100, 0.01, -0.06, 0.02};  // prediction - DEM; the first two rows do not count
  for (std::size_t i = 0; i < 5; ++i) s.test.rows[i].s_par = s.prediction.rows[i].s_par - shift[i];
  const auto q = quantity(compare(s.prediction, s.test), "s_par");
  EXPECT_EQ(q.rows, 3);
  EXPECT_NEAR(q.bias, -0.01, 1e-16);
  EXPECT_NEAR(q.rms, std::sqrt((1e-4 + 36e-4 + 4e-4) / 3), 1e-16);
  double largest_observed = 0;
  for (std::size_t i = 2; i < 5; ++i) largest_observed = std::max(largest_observed, std::abs(s.test.rows[i].s_par));
  EXPECT_NEAR(q.normalised_rms, q.rms / largest_observed, 1e-15);
  EXPECT_NEAR(q.largest, -0.06, 1e-16);
  EXPECT_NEAR(q.largest_at_eps_dev, 0.02, 1e-15);
  EXPECT_EQ(q.largest_at_nu, 0.74);
}

TEST(Compare, RowsCountByTheShearPathWhichGrowsOnReversalToo) {
  const std::vector<PathSegment> there_and_back{leg(Mode::D2, 0.02), leg(Mode::D2, 0.02, true)};
  const double length = resolve({0.74, Branch::unloading, there_and_back})[1].length;
  const Scene s = scene(there_and_back, {{0, 0.0}, {1, length / 2}, {1, length}});
  EXPECT_NEAR(s.prediction.rows.back().eps_dev, 0, 1e-16) << "the last row is at the strain of the first";
  EXPECT_EQ(quantity(compare(s.prediction, s.test), "s_par").rows, 2);
}

TEST(Compare, IsotropicPathsCountEveryRow) {
  const Scene s = scene(Mode::ISO);
  const Comparison comparison = compare(s.prediction, s.test);
  EXPECT_EQ(quantity(comparison, "P_star").rows, 5);
  for (const char* name : {"s_par", "F_par"}) {
    EXPECT_EQ(quantity(comparison, name).rows, 0) << "undefined without shear";
    EXPECT_TRUE(std::isnan(quantity(comparison, name).bias));
    EXPECT_TRUE(std::isnan(quantity(comparison, name).normalised_rms));
    EXPECT_TRUE(std::isnan(quantity(comparison, name).largest_at_nu));
  }
}

TEST(Compare, PredictionMayEndEarly) {
  Scene s = scene();
  s.prediction.rows.resize(4);
  EXPECT_EQ(quantity(compare(s.prediction, s.test), "P_star").rows, 2);
  s.prediction.rows.clear();
  EXPECT_EQ(quantity(compare(s.prediction, s.test), "P_star").rows, 0);
}

TEST(Compare, UndefinedObservationsDoNotCount) {
  Scene s = scene();
  s.test.rows[3].F_par = kNaN;
  EXPECT_EQ(quantity(compare(s.prediction, s.test), "F_par").rows, 2);
  EXPECT_EQ(quantity(compare(s.prediction, s.test), "s_par").rows, 3);
}

TEST(Compare, OtherStrainsAreRefused) {
  Scene s = scene();
  s.test.rows[2].strain.tensor(0, 0) += 1e-6;
  EXPECT_THROW(compare(s.prediction, s.test), InvalidInput);
  s = scene();
  s.test.rows.pop_back();
  EXPECT_THROW(compare(s.prediction, s.test), InvalidInput) << "more predicted than observed";
  s = scene();
  s.test.rows[1].strain.tensor(0, 0) = kNaN;
  EXPECT_THROW(compare(s.prediction, s.test), InvalidInput);
}

TEST(Compare, CoverageIsTheShareOfRowsWithinTheBand) {
  Scene s = scene();  // rows 2, 3, 4 count
  for (auto& row : s.prediction.rows) {
    row.mean.s_par = 0.01;
    row.single.s_par = 0.02;
  }
  s.test.rows[0].s_par += 1;
  s.test.rows[2].s_par += 0.009;
  s.test.rows[3].s_par -= 0.015;
  s.test.rows[4].s_par += 0.03;
  const Comparison comparison = compare(s.prediction, s.test);
  EXPECT_DOUBLE_EQ(quantity(comparison, "s_par").coverage_mean, 1. / 3);
  EXPECT_DOUBLE_EQ(quantity(comparison, "s_par").coverage_single, 2. / 3);
  EXPECT_TRUE(std::isnan(quantity(comparison, "P_star").coverage_mean)) << "no band, no share";
  s.prediction.rows[4].mean.s_par = kNaN;
  EXPECT_DOUBLE_EQ(quantity(compare(s.prediction, s.test), "s_par").coverage_mean, 1. / 2);
}

}  // namespace
}  // namespace grainlaw::predict
