#include "fit/stages/evolution_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/fit_stages.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

using testing::estimate;
const LawParameters<double> kTruth = testing::synthetic_truth();

std::vector<Trajectory> trajectories(const std::vector<TestRecord>& tests) {
  return trajectories_of(check_and_sort(tests), kTruth.isotropic.pressure.nu_c, {});
}

testing::SyntheticOptions small() {
  testing::SyntheticOptions options;
  options.densities = {0.68, 0.74, 0.80};
  options.seeds = {1};
  options.rows = 40;
  return options;
}

Problem evolution_problem(const std::vector<Trajectory>& all) {
  return problem_of(evolution_stage(all, {}, {}), kTruth);
}

/// Lets a trajectory of one axis be compared along a second one, too, which is returned.
Deviator<double> add_axis(Trajectory& sheared) {
  const Deviator<double> N = sheared.axes.front();
  const Deviator<double> M = Deviator<double>::Unit(N.cwiseAbs().maxCoeff() == std::abs(N[0]) ? 1 : 0);
  return sheared.axes.emplace_back((M - N * N.dot(M)).normalized());
}

TEST(EvolutionFit, TruthHasNoMisfit) {
  const auto all = trajectories(testing::synthetic_dataset(kTruth, small()));
  const Problem problem = evolution_problem(all);
  ASSERT_EQ(problem.parameters.size(), 16u);
  ASSERT_EQ(problem.blocks.size(), all.size());
  std::vector<double> x;
  for (const FreeParameter& p : problem.parameters) x.push_back(p.start);
  for (const ResidualBlock& block : problem.blocks) {
    Eigen::VectorXd misfit(block.rows());
    ASSERT_TRUE(block.evaluate(x.data(), misfit.data(), nullptr));
    EXPECT_LT(misfit.lpNorm<Eigen::Infinity>(), 2e-8) << block.test;
  }
}

// Misfit is law minus data along each axis: data moved by known amounts along two axes show just these, in the rows of
// their quantity and axis.
TEST(EvolutionFit, EachAxisHasItsOwnRows) {
  auto all = trajectories(testing::synthetic_dataset(kTruth, small()));
  std::erase_if(all, [](const Trajectory& t) { return t.axes.size() != 1; });
  ASSERT_FALSE(all.empty());
  Trajectory& sheared = all.front();
  const Deviator<double> N = sheared.axes.front(), M = add_axis(sheared);
  for (TrajectoryRow& row : sheared.rows) {
    row.data.sigma += row.data.P * (0.003 * N + 0.004 * M);
    row.data.F += 0.01 * N + 0.02 * M;
  }
  const Problem problem = evolution_problem({sheared});
  std::vector<double> x;
  for (const FreeParameter& p : problem.parameters) x.push_back(p.start);
  const ResidualBlock& block = problem.blocks.front();
  Eigen::VectorXd misfit(block.rows());
  ASSERT_TRUE(block.evaluate(x.data(), misfit.data(), nullptr));
  const std::map<std::string, double> expected{
      {"P_star", 0}, {"s_par", -0.003}, {"s_axis2", -0.004}, {"F_par", -0.01}, {"F_axis2", -0.02}};
  ASSERT_EQ(block.channels.size(), expected.size());
  for (const Channel& channel : block.channels) {
    const auto rows = misfit.segment(channel.first, channel.rows).array();
    EXPECT_LT((rows - expected.at(channel.quantity)).abs().maxCoeff(), 2e-8) << channel.quantity;
  }
}

// A stress along a second axis, which no parameter of the law changes, says nothing of the fabric's saturation.
TEST(EvolutionFit, SaturationIsJudgedByTheQuantitysOwnMisfit) {
  auto all = trajectories(testing::synthetic_dataset(kTruth, small()));
  for (Trajectory& t : all) {
    if (t.axes.size() != 1) continue;
    const Deviator<double> M = add_axis(t);
    for (TrajectoryRow& row : t.rows) row.data.sigma += 0.5 * row.data.P * M;
  }
  LawParameters<double> law = kTruth;
  const StageFit fit = run_stage(evolution_stage(all, {}, {}), law, {}, {});
  for (const char* name :
       {"stress_ratio_max.Q_limit", "stress_rate.Q_limit", "fabric_max.Q_limit", "fabric_rate.Q_limit"}) {
    EXPECT_NE(estimate(fit, name).status, Status::not_identified) << name << ": " << estimate(fit, name).note;
  }
}

TEST(EvolutionFit, PressureInShearIsShownAndNotFitted) {
  const auto all = trajectories(testing::synthetic_dataset(kTruth, small()));
  for (const ResidualBlock& block : evolution_problem(all).blocks) {
    const Channel& pressure = block.channels.at(0);
    ASSERT_EQ(pressure.quantity, "P_star");
    const double weight = block.weight.segment(pressure.first, pressure.rows).maxCoeff();
    if (block.channels.size() == 1)
      EXPECT_GT(weight, 0) << block.test;
    else
      EXPECT_EQ(weight, 0) << block.test;
  }
}

// Packings whose P* is 30 % more and less than the law's: all rows weigh by the law.
TEST(EvolutionFit, PressureWeighsByTheLaw) {
  std::vector<TestRecord> tests = testing::synthetic_dataset(kTruth, small());
  for (TestRecord& test : tests) {
    const double factor = test.packing.seed % 2 == 0 ? 1.3 : 0.7;
    for (Observation& row : test.rows) row.P_star *= factor, row.stress.tensor *= factor;
  }
  const auto all = trajectories(tests);
  const Problem problem = evolution_problem(all);
  int counted = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!all[k].starts_on_law) continue;
    for (std::size_t i = 0; i < all[k].rows.size(); ++i) {
      const TrajectoryRow& row = all[k].rows[i];
      const double law = kTruth.isotropic.P_star(all[k].nu(row.e));
      EXPECT_NEAR(problem.blocks[k].weight[static_cast<Eigen::Index>(i)] * CalibrationOptions{}.pressure_scale * law,
                  row.weight, 1e-12 * row.weight);
      ++counted;
    }
  }
  EXPECT_GT(counted, 20);
}

TEST(EvolutionFit, DilatancyDoesNotCorruptStressAndFabric) {
  // P rises by 40 % at .68 while s and F stay as Eq. (16) has them. That is no law any more, since A1 of Eq. (16) changes
  // P and with it s by about a percent; s_max, beta_s, F_max, beta_F and a2 must be found to this.
  testing::SyntheticOptions options = small();
  options.dilatancy_strain = 0.05;
  const auto all = trajectories(testing::synthetic_dataset(kTruth, options));
  LawParameters<double> law = kTruth;
  const StageFit fit = run_stage(evolution_stage(all, {}, {}), law, {}, {});
  ASSERT_TRUE(fit.stage.converged) << fit.stage.termination;
  for (const double nu : {0.68, 0.74, 0.80}) {
    const auto near = [&](auto field, double tolerance) {
      const double expected = (kTruth.*field).value(nu, kTruth.shear_nu_c);
      EXPECT_NEAR((law.*field).value(nu, law.shear_nu_c), expected, tolerance * expected) << nu;
    };
    near(&LawParameters<double>::stress_ratio_max, 0.01);
    near(&LawParameters<double>::stress_rate, 0.03);
    near(&LawParameters<double>::fabric_max, 0.01);
    near(&LawParameters<double>::fabric_rate, 0.01);
    EXPECT_NEAR(law.isotropic.P_star(nu), kTruth.isotropic.P_star(nu), 0.01 * kTruth.isotropic.P_star(nu)) << nu;
  }
  EXPECT_NEAR(law.anisotropy.a2, kTruth.anisotropy.a2, 0.05);
  // ... and the gap in P is seen for what it is: a third too low at .68.
  for (const TestResidual& t : fit.stage.tests) {
    if (t.test == "d2-0.6800-s1" && t.quantity == "P_star") {
      EXPECT_FALSE(t.in_cost);
      EXPECT_LT(t.bias / t.max_abs_data, -0.15);
    }
  }
}

TEST(EvolutionFit, CouplingNeedsAPathThatChangesTheVolumeOfAShearedState) {
  testing::SyntheticOptions options = small();
  options.sequences = false;
  const auto all = trajectories(testing::synthetic_dataset(kTruth, options));
  EXPECT_FALSE(contains_anisotropy(all));
  LawParameters<double> law = kTruth;
  const StageFit fit = run_stage(evolution_stage(all, {}, {}), law, {}, {});
  EXPECT_EQ(estimate(fit, "anisotropy.a2").status, Status::not_identified);
  EXPECT_NE(estimate(fit, "anisotropy.a2").note.find("then ISO"), std::string::npos);
  const TiedCoupling tied = tied_a1(all, law, estimate(fit, "anisotropy.a2"), Eigen::RowVector2d(0, 0), {});
  EXPECT_EQ(tied.a1.status, Status::not_identified);
}

TEST(EvolutionFit, A1FollowsFromA2ByTheEnergyIdentity) {
  testing::SyntheticOptions options = small();
  options.seeds = {1, 2};
  const auto all = trajectories(testing::synthetic_dataset(kTruth, options));
  const Estimate a2{1.18, 0.06, Status::fitted, "", 1};
  const Eigen::RowVector2d influence(0.06 / std::sqrt(2.0), -0.06 / std::sqrt(2.0));
  const TiedCoupling tied = tied_a1(all, kTruth, a2, influence, {});
  EXPECT_EQ(tied.a1.status, Status::tied);
  // Steady: sigma_N = s_max P, F_N = F_max; D2 and the last row of each D2->ISO give the same ratio at a density.
  double mean = 0;
  for (const double nu : {0.68, 0.74, 0.80}) {
    const double P_end = [&] {
      for (const Trajectory& t : all) {
        if (t.nu_start == nu && t.test.rfind("d2-iso", 0) != 0 && !t.starts_on_law) return t.rows.back().data.P;
      }
      return 0.0;
    }();
    mean += kTruth.stress_ratio_max.value(nu, kTruth.shear_nu_c) * P_end /
            (kTruth.isotropic.B_star(nu) * kTruth.fabric_max.value(nu, kTruth.shear_nu_c)) / 3;
  }
  EXPECT_NEAR(tied.a1.value, 2. / 3 * (1.18 - mean), 2e-3);
  // Without noise both packings have the same ratio: what they did to a2 is all.
  EXPECT_NEAR((tied.influence - 2. / 3 * influence).norm(), 0, 1e-9);
  EXPECT_NEAR(tied.a1.standard_error, 2. / 3 * 0.06, 1e-9);
  EXPECT_EQ(tied.a1.degrees_of_freedom, 1);
}

// Few spheres: the fabric of a row may come out as none, or against the shear. Rows in pairs, one that much too large, one too small.
TEST(EvolutionFit, A1OfFabricThatScattersIsThatOfItsMean) {
  auto all = trajectories(testing::synthetic_dataset(kTruth, small()));
  const Estimate a2{1.18, 0.06, Status::fitted, "", 1};
  const double clean = tied_a1(all, kTruth, a2, Eigen::RowVector2d(0, 0), {}).a1.value;
  for (Trajectory& t : all) {
    if (t.direction.de == 0 || std::abs(t.direction.dx) > 1e-12) continue;
    for (std::size_t i = t.rows.size() % 2; i + 1 < t.rows.size(); i += 2) {
      if (t.direction.de * t.rows[i].e < CalibrationOptions{}.steady_from) continue;
      t.rows[i].data.F *= 2.5;
      t.rows[i + 1].data.F *= -0.5;
    }
  }
  EXPECT_NEAR(tied_a1(all, kTruth, a2, Eigen::RowVector2d(0, 0), {}).a1.value, clean, 2e-3);
}

}  // namespace
}  // namespace grainlaw::fit
