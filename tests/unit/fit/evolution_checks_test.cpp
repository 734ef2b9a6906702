#include "fit/stages/evolution_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::fit {
namespace {

constexpr int kShearRows = 40;

/// D2 at `nu` that saturates by Eq. (17), one axis.
Trajectory saturating_shear(double nu, double s_max, double beta_s) {
  Trajectory t;
  t.nu_start = nu;
  t.direction = law_direction(direction_of(Mode::D2, "xyz", false));
  t.axes = {t.direction.N};
  for (int i = 1; i <= kShearRows; ++i) {
    TrajectoryRow& row = t.rows.emplace_back();
    row.e = 0.01 * i / t.direction.de;
    row.weight = 1;
    row.data.P = 0.02;
    row.data.sigma = 0.02 * s_max * (1 - std::exp(-beta_s * 0.01 * i)) * t.direction.N;
  }
  t.start.P = 0.02;
  return t;
}

/// Of a stage in which nothing but the rate of the stress ratio was free, and packings move its parameters along `move`.
Status status_of_rate(const Eigen::Vector3d& move) {
  LawParameters<double> law = published_parameters();
  std::vector<Trajectory> trajectories;
  for (const double nu : {0.72, 0.75, 0.78})
    trajectories.push_back(saturating_shear(nu, 0.15, law.stress_rate.value(nu, law.shear_nu_c)));
  StageFit fit;
  for (const auto& [name, value] : {std::pair{"stress_rate.Q_limit", law.stress_rate.Q_limit},
                                    {"stress_rate.Q_c", law.stress_rate.Q_c},
                                    {"stress_rate.alpha", law.stress_rate.alpha}})
    fit.stage.estimates.push_back({name, {value, 1, Status::fitted, ""}});
  fit.influence = move;
  fit.solution.x = Eigen::Vector3d(law.stress_rate.Q_limit, law.stress_rate.Q_c, law.stress_rate.alpha);
  const Eigen::Index rows = 3 * 3 * kShearRows;  // P, one axis of stress and of fabric
  fit.solution.misfit = Eigen::VectorXd::Zero(rows);
  fit.solution.weight = Eigen::VectorXd::Ones(rows);
  fit.solution.jacobian = Eigen::MatrixXd::Ones(rows, 3);
  check_evolution(trajectories, law, {}, fit);
  return fit.stage.estimates.front().estimate.status;
}

// Q_c and alpha may be off together, so that the rate itself, Q_limit + Q_c exp(-alpha y), is known where shear was seen.
TEST(EvolutionChecks, ARateIsKnownByItsErrorAtTheMedianDensity) {
  const ExponentialLaw<double> rate = published_parameters().stress_rate;
  const double nu_c = published_parameters().shear_nu_c, y = 0.75 / nu_c - 1, value = rate.value(0.75, nu_c);
  const double slope = -rate.Q_c * y * std::exp(-rate.alpha * y);  // of the rate along alpha
  const double h = 1e-6;
  ExponentialLaw<double> beyond = rate;
  beyond.alpha += h;
  ASSERT_NEAR(slope, (beyond.value(0.75, nu_c) - value) / h, 1e-4 * std::abs(slope));
  const double far = 0.6 * value / std::abs(slope);  // of alpha: changes the rate by 60 %
  EXPECT_EQ(status_of_rate({0, 0, far}), Status::not_identified);
  EXPECT_EQ(status_of_rate({0, 0, far / 2}), Status::fitted);
  EXPECT_EQ(status_of_rate({0, rate.Q_c * y * far, far}), Status::fitted) << "the rate stays as it is";
  EXPECT_EQ(status_of_rate({0, -rate.Q_c * y * far, far}), Status::not_identified);
}

}  // namespace
}  // namespace grainlaw::fit
