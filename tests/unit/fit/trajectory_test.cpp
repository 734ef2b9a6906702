#include "fit/stages/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/reduced_law.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

Trajectory shear_at(double nu, const LawParameters<double>& p, double strain, int rows) {
  Trajectory t;
  t.direction = law_direction(direction_of(Mode::D2));
  t.nu_start = nu;
  t.start = {p.isotropic.P_star(nu), Deviator<double>::Zero(), Deviator<double>::Zero()};
  t.axes = {t.direction.N};
  for (int i = 1; i <= rows; ++i) t.rows.push_back({strain / t.direction.de * i / rows, {}, 1});
  return t;
}

double largest_error(double max_step, double& fabric_error) {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a0 = 0;  // Eqs. (17) and (18) exactly
  const Trajectory t = shear_at(0.70, p, 0.2, 4);
  const double s_max = p.stress_ratio_max.value(0.70, p.shear_nu_c), beta_s = p.stress_rate.value(0.70, p.shear_nu_c);
  const double F_max = p.fabric_max.value(0.70, p.shear_nu_c), beta_F = p.fabric_rate.value(0.70, p.shear_nu_c);
  double error = 0;
  fabric_error = 0;
  EXPECT_TRUE(
      integrate(t, p, Rung::evolution, Coupling::single, max_step, [&](std::size_t i, const LawState<double>& y) {
        const double e = t.rows[i].e * t.direction.de;
        error = std::max(error, std::abs(y.sigma.dot(t.direction.N) / y.P - saturating(s_max, 0.0, beta_s, e)));
        fabric_error = std::max(fabric_error, std::abs(y.F.dot(t.direction.N) - saturating(F_max, 0.0, beta_F, e)));
      }));
  return error;
}

TEST(Trajectory, IntegratorHasOrderSix) {
  double F1 = 0, F2 = 0;
  const double s1 = largest_error(4e-3, F1), s2 = largest_error(2e-3, F2);
  EXPECT_NEAR(std::log2(s1 / s2), 6, 0.3);
  EXPECT_NEAR(std::log2(F1 / F2), 6, 0.3);
  EXPECT_LT(largest_error(CalibrationOptions{}.max_step, F1), 1e-8);
}

TEST(Trajectory, IsotropicPathIsEq14) {
  const LawParameters<double> p = testing::synthetic_truth();
  Trajectory t;
  t.direction = law_direction(direction_of(Mode::ISO, "xyz", true));
  t.nu_start = 0.82;
  t.starts_on_law = true;
  for (int i = 1; i <= 50; ++i) t.rows.push_back({std::log(0.82 / 0.675) / 3 * i / 50, {}, 1});
  ASSERT_TRUE(integrate(t, p, Rung::evolution, Coupling::energy, 2e-3, [&](std::size_t i, const LawState<double>& y) {
    const double nu = t.nu(t.rows[i].e);
    EXPECT_NEAR(y.P, p.isotropic.P_star(nu), 1e-9 * y.P) << nu;
  }));
  EXPECT_NEAR(t.nu(t.rows.back().e), 0.675, 1e-12);
}

TEST(Trajectory, SaysWhenThePressureIsGone) {
  const LawParameters<double> p = testing::synthetic_truth();
  Trajectory t;
  t.direction = law_direction(direction_of(Mode::ISO, "xyz", true));
  t.nu_start = 0.70;
  t.start = {1e-4, Deviator<double>::Zero(), Deviator<double>::Zero()};  // far below Eq. (14): used up on the way
  t.rows.push_back({0.01, {}, 1});
  EXPECT_FALSE(integrate(t, p, Rung::evolution, Coupling::energy, 2e-3, [](std::size_t, const LawState<double>&) {}));
}

TEST(Trajectory, OnePerSegmentEachFromItsCorner) {
  testing::SyntheticOptions options;
  options.densities = {0.70};
  options.seeds = {1};
  options.rows = 40;
  const std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  const DataSet data = check_and_sort(tests);
  const std::vector<Trajectory> all = trajectories_of(data, 0.6649, {});
  ASSERT_EQ(all.size(), 1u + 1u + 3u);
  EXPECT_TRUE(all[0].starts_on_law);
  EXPECT_TRUE(all[0].axes.empty());
  for (const TrajectoryRow& row : all[0].rows) EXPECT_GE(all[0].nu(row.e), 0.675 - 1e-12);
  EXPECT_EQ(static_cast<int>(all[0].rows.size()) + all[0].excluded, 40);
  for (std::size_t k = 2; k < 5; ++k) {
    EXPECT_EQ(all[k].segment, static_cast<int>(k) - 2);
    EXPECT_EQ(all[k].axes.size(), 1u);
    EXPECT_EQ(all[k].cluster, all[1].cluster);
  }
  EXPECT_NEAR(all[3].nu_start, 0.70, 1e-12);
  EXPECT_NEAR(all[4].nu_start, 0.73, 1e-12);
  const Observation& corner = tests[2].rows[40];
  EXPECT_EQ(all[3].start.P, corner.P_star);
  EXPECT_NEAR(all[3].start.F.dot(all[3].axes[0]), corner.F_par, 1e-14);
  EXPECT_NEAR(all[3].rows.back().e, std::log(0.73 / 0.70) / 3, 1e-12);
  EXPECT_EQ(all[3].rows.size(), 40u);  // no window where the volume changes
}

// Rates of other programs are in 1/s: what is left of a trace by rounding is as large as they are.
TEST(Trajectory, ConstantVolumeIsBesideTheShear) {
  Trajectory t;
  for (const double unit : {1.0, 1e-9, 1e9}) {
    t.direction =
        law_direction(StrainRate{unit * Eigen::Vector3d(12000.1, 345.7, -12345.8).asDiagonal().toDenseMatrix()});
    EXPECT_TRUE(t.constant_volume()) << unit << " " << t.direction.dx;
    t.direction =
        law_direction(StrainRate{unit * Eigen::Vector3d(12000.1, 345.7, -12345.9).asDiagonal().toDenseMatrix()});
    EXPECT_FALSE(t.constant_volume()) << unit;
  }
  t.direction = law_direction(direction_of(Mode::ISO));
  EXPECT_FALSE(t.constant_volume());
}

TEST(Trajectory, SegmentsOfAnotherModeAddTheirOwnAxis) {
  testing::SyntheticOptions options;
  options.rows = 10;
  testing::SyntheticDataset set(testing::synthetic_truth(), options);
  std::vector<TestRecord> tests{set.isotropic_unloading(1)};
  tests.push_back(set.test("d2", 1, 0.70, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.3)}));
  tests.push_back(set.test("d2-d3", 1, 0.70,
                           {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.1),
                            testing::synthetic_segment(Mode::D3, ExtentKind::eps_dev, 0.1)}));
  const std::vector<Trajectory> all = trajectories_of(check_and_sort(tests), 0.6649, {});
  ASSERT_EQ(all.size(), 4u);
  ASSERT_EQ(all[3].axes.size(), 2u);
  EXPECT_NEAR(all[3].axes[0].dot(all[3].axes[1]), 0, 1e-14);
  EXPECT_NEAR((all[3].direction.N - all[3].axes[0] * all[3].axes[0].dot(all[3].direction.N) -
               all[3].axes[1] * all[3].axes[1].dot(all[3].direction.N))
                  .norm(),
              0, 1e-12);
}

// As predictions have it (path_direction()), so that a law is fitted to what it predicts.
TEST(Trajectory, ShearBelowAThousandthOfTheVolumeStrainIsNone) {
  testing::SyntheticDataset set(testing::synthetic_truth(), {});
  TestRecord record = set.isotropic_unloading(1);
  record.path.segments[0].direction.tensor(2, 2) *= 1 + 1e-6;
  const TestRecord shear = set.test("d2", 1, 0.70, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.3)});
  const std::vector<Trajectory> all = trajectories_of(check_and_sort({record, shear}), 0.6649, {});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_TRUE(all[0].axes.empty());
  EXPECT_EQ(all[0].direction.de, 0);
  EXPECT_TRUE(all[0].starts_on_law);
}

TEST(Trajectory, RowsBelowJammingEndIt) {
  testing::SyntheticOptions options;
  options.rows = 50;
  testing::SyntheticDataset set(testing::synthetic_truth(), options);
  std::vector<TestRecord> tests{set.isotropic_unloading(1)};
  tests.push_back(set.test("d2", 1, 0.70, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.3)}));
  const DataSet data = check_and_sort(tests);
  EXPECT_TRUE(trajectories_of(data, 0.71, {})[1].rows.empty());
  EXPECT_EQ(trajectories_of(data, 0.71, {})[1].excluded, 50);
}

// Close to jamming a measured start that carries less than the law would use up its pressure above nu_c, and with it the stage.
TEST(Trajectory, UnloadingAfterShearEndsWhereIsotropicUnloadingDoes) {
  testing::SyntheticOptions options;
  options.rows = 50;
  testing::SyntheticDataset set(testing::synthetic_truth(), options);
  std::vector<TestRecord> tests{set.isotropic_unloading(1)};
  tests.push_back(set.test("d2", 1, 0.71, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.3)}));
  tests.push_back(set.test("d2-out", 1, 0.70,
                           {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.1),
                            testing::synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.67, true)}));
  const std::vector<Trajectory> all = trajectories_of(check_and_sort(tests), 0.6649, {});
  ASSERT_EQ(all.size(), 4u);
  EXPECT_GT(all[3].rows.size(), 30u);
  EXPECT_GT(all[3].excluded, 0);
  EXPECT_GE(all[3].nu(all[3].rows.back().e), CalibrationOptions{}.iso_nu_min - 1e-12);
}

TEST(Trajectory, RowsOffThePathAreNamed) {
  testing::SyntheticOptions options;
  options.densities = {0.70};
  options.seeds = {1};
  options.rows = 10;
  std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  tests[1].rows[4].strain.tensor(0, 1) += 1e-3;
  tests[1].rows[4].strain.tensor(1, 0) += 1e-3;
  try {
    trajectories_of(check_and_sort(tests), 0.6649, {});
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("row 5"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace grainlaw::fit
