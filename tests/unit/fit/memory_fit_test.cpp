#include "fit/stages/memory_fit.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fit/calibrate.hpp"
#include "tests/support/fit_stages.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

using testing::estimate;
using testing::SyntheticOptions;

/// Parameters of the size that DEM gives.
LawParameters<double> memory_truth() {
  LawParameters<double> p = testing::synthetic_truth();
  p.memory = {0.8, 0.7, 2.5, 10, 45, 10, 1.1, 0.7, 0.6, 1.18};
  return p;
}

SyntheticOptions of_memory() {
  SyntheticOptions options;
  options.rung = Rung::memory;
  options.rows = 60;
  return options;
}

std::vector<Trajectory> memory_trajectories(const std::vector<TestRecord>& tests) {
  return trajectories_of(check_and_sort(tests), memory_truth().isotropic.pressure.nu_c, {});
}

/// The memory_truth with memory's parameters where a fit begins.
LawParameters<double> at_start() {
  LawParameters<double> p = memory_truth();
  p.memory = start_parameters().memory;
  return p;
}

TEST(MemoryFit, GivesBackWhatMadeTheData) {
  const auto tests = testing::synthetic_dataset(memory_truth(), of_memory());
  LawParameters<double> law = at_start();
  const StageFit fit = run_stage(memory_stage(memory_trajectories(tests), {}), law, {}, {});
  EXPECT_TRUE(fit.stage.converged) << fit.stage.termination;
  const LawParameters<double> expected = memory_truth();
  EXPECT_NEAR(law.memory.G, expected.memory.G, 1e-5);
  EXPECT_NEAR(law.memory.alpha, expected.memory.alpha, 1e-5);
  EXPECT_NEAR(law.memory.k, expected.memory.k, 1e-3);
  EXPECT_NEAR(law.memory.lambda, expected.memory.lambda, 1e-2);
  EXPECT_NEAR(law.memory.c_F, expected.memory.c_F, 1e-4);
  EXPECT_NEAR(law.memory.a2, expected.memory.a2, 1e-5);
  EXPECT_NEAR(law.memory.chi, expected.memory.chi, 1e-4);
  EXPECT_NEAR(law.memory.kappa, expected.memory.kappa, 1e-4);
  EXPECT_EQ(law.memory.m, 2.5) << "fixed";
  EXPECT_EQ(law.memory.a_P, 1.18) << "fixed";
  for (const char* name : {"memory.G", "memory.alpha", "memory.k", "memory.lambda", "memory.c_F", "memory.a2",
                           "memory.chi", "memory.kappa"})
    EXPECT_EQ(estimate(fit, name).status, Status::fitted) << name;
}

TEST(MemoryFit, WithoutVolumeChangeAfterShearTwoAreNotIdentified) {
  SyntheticOptions options = of_memory();
  options.sequences = false;
  LawParameters<double> law = at_start();
  const auto trajectories = memory_trajectories(testing::synthetic_dataset(memory_truth(), options));
  const StageFit fit = run_stage(memory_stage(trajectories, {}), law, {}, {});
  for (const char* name : {"memory.c_F", "memory.a2"}) {
    EXPECT_EQ(estimate(fit, name).status, Status::not_identified) << name;
    EXPECT_NE(estimate(fit, name).note.find("ISO"), std::string::npos) << "names the remedy";
  }
  EXPECT_EQ(estimate(fit, "memory.k").status, Status::fitted);
}

// Where all of the fabric may follow stress at once, nobody asks at what rate the rest follows.
TEST(MemoryFit, TheRateOfALagThatMayBeNoneNeedNotBeKnown) {
  LawParameters<double> truth = memory_truth();
  SyntheticOptions options = of_memory();
  options.noise_s = options.noise_F = 0.01;
  options.seeds = {1, 2, 3};
  options.rows = 12;
  for (const double kappa : {0.5, 0.85}) {
    truth.memory.kappa = kappa;
    LawParameters<double> law = at_start();
    const auto trajectories = memory_trajectories(testing::synthetic_dataset(truth, options));
    const StageFit fit = run_stage(memory_stage(trajectories, {}), law, {}, {});
    const Estimate lambda = estimate(fit, "memory.lambda");
    EXPECT_NE(lambda.status, Status::not_identified) << kappa << ": " << lambda.note;
    const bool vague = !(lambda.standard_error <= 0.5 * lambda.value);  // on a bound it has no error
    EXPECT_EQ(vague, kappa > 0.8) << lambda.value << " +- " << lambda.standard_error;
  }
}

// At kappa = 0 all fabric lags, and at which rate is all there is to know.
TEST(MemoryFit, OfALagThatIsCertainTheRateMustBeKnown) {
  SyntheticOptions options = of_memory();
  options.rows = 8;
  options.seeds = {1};
  const StageDefinition stage =
      memory_stage(memory_trajectories(testing::synthetic_dataset(memory_truth(), options)), {});
  for (const double kappa : {0.0, parameter_table()[parameter_index("memory.kappa")].upper}) {
    StageFit fit;
    fit.stage.estimates = {{"memory.lambda", {40, 60, Status::fitted, "", 4}},
                           {"memory.kappa", {kappa, std::nan(""), Status::at_bound, ""}}};
    fit.influence = Eigen::MatrixXd::Zero(2, 2);
    stage.judge(fit, memory_truth());
    EXPECT_EQ(fit.stage.estimates[0].estimate.status, kappa == 0 ? Status::not_identified : Status::fitted) << kappa;
  }
}

// Weights 1/d_i of noisy data d_i favour the low ones: the level of a constant P comes out too low by twice the square of the
// relative noise. One weight for all rows of a test has no such bias.
TEST(MemoryFit, PressureIsRelativeToTheMeanOfTheTest) {
  const CalibrationOptions options;
  for (const Trajectory& t : memory_trajectories(testing::synthetic_dataset(memory_truth(), of_memory()))) {
    if (t.axes.empty() || std::abs(t.direction.dx) > 1e-12) continue;
    const Problem problem = problem_of(memory_stage({t}, options), memory_truth());
    const Channel& P = problem.blocks.front().channels.front();
    ASSERT_EQ(P.quantity, "P_star");
    double mean = 0;
    for (const TrajectoryRow& row : t.rows) mean += row.data.P / P.rows;
    const double expected = 1 / (std::sqrt(P.rows) * options.pressure_scale * mean);
    const Eigen::VectorXd w = problem.blocks.front().weight.segment(P.first, P.rows);
    EXPECT_LT((w.array() - expected).abs().maxCoeff(), 1e-12 * expected) << t.test;
  }
}

// Packings differ in their jamming density: one carries more at all times, another less. That is no state that relaxes.
TEST(MemoryFit, PackingsThatCarryMoreOrLessGiveTheLawOfTheirMean) {
  auto tests = testing::synthetic_dataset(memory_truth(), of_memory());
  for (TestRecord& test : tests) {
    const double factor = test.packing.seed == 1 ? 1.03 : 0.97;
    for (Observation& row : test.rows) {
      row.P_star *= factor;
      row.stress.tensor *= factor;
    }
  }
  LawParameters<double> law = at_start();
  run_stage(memory_stage(memory_trajectories(tests), {}), law, {}, {});
  const auto found = fields(law);
  const LawParameters<double> expected = memory_truth();
  const auto true_value = fields(expected);
  for (const char* name : {"memory.G", "memory.alpha", "memory.k", "memory.lambda", "memory.c_F", "memory.a2",
                           "memory.chi", "memory.kappa"}) {
    const std::size_t i = parameter_index(name);
    EXPECT_NEAR(*found[i] / *true_value[i], 1, 0.02) << name;
  }
}

// A pressure that all packings have at their starts, and the law has not, is the law's misfit: they are followed at their nu. So
// is what those carry more that start on the other branch.
TEST(MemoryFit, WhatAllPackingsCarryMoreThanTheLawIsNoDensityOfTheirs) {
  const CalibrationOptions options;
  auto all = memory_trajectories(testing::synthetic_dataset(memory_truth(), of_memory()));
  for (Trajectory& t : all) t.start.P *= 1.03;
  for (std::size_t i = 0, n = all.size(); i < n; ++i) {
    Trajectory loading = all[i];
    loading.test += "-loading";
    loading.branch = Branch::loading;
    loading.start.P *= 1.1;
    all.push_back(loading);
  }
  LawParameters<double> truth = memory_truth();
  const Problem problem = problem_of(memory_stage(all, options), truth);
  std::vector<double> x;
  for (const FreeParameter& p : problem.parameters) x.push_back(*fields(truth)[parameter_index(p.name)]);
  std::size_t sheared = 0;
  for (const Trajectory& t : all) {
    if (t.axes.empty()) continue;
    const ResidualBlock& block = problem.blocks.at(sheared++);
    std::vector<double> misfit(static_cast<std::size_t>(block.rows()));
    ASSERT_TRUE(block.evaluate(x.data(), misfit.data(), nullptr));
    EXPECT_TRUE(integrate<double>(t, truth, Rung::memory, Coupling::energy, options.max_step,
                                  [&](std::size_t i, const LawState<double>& y) {
                                    EXPECT_NEAR(misfit[i], y.P - t.rows[i].data.P, 1e-12 * y.P) << t.test;
                                  }));
  }
}

// Small packings start with some shear, each of its own, as much as .06 of P at 800 spheres: that sets none apart from the others.
TEST(MemoryFit, EachPackingIsAsDenseAsItsStartTells) {
  const CalibrationOptions options;
  LawParameters<double> truth = memory_truth();
  auto all = memory_trajectories(testing::synthetic_dataset(truth, of_memory()));
  for (Trajectory& t : all) {
    t.start.P *= t.cluster == 0 ? 1.03 : 0.97;
    if (!t.axes.empty()) t.start.sigma += (t.cluster == 0 ? 0.06 : -0.06) * t.start.P * t.axes.front();
  }
  const Problem problem = problem_of(memory_stage(all, options), truth);
  std::vector<double> x;
  for (const FreeParameter& p : problem.parameters) x.push_back(*fields(truth)[parameter_index(p.name)]);
  std::size_t next = 0;
  for (Trajectory t : all) {
    if (t.axes.empty()) continue;
    const ResidualBlock& block = problem.blocks.at(next++);
    if (t.segment > 0) continue;
    const double nu = t.nu_start, P = truth.isotropic.P_star(nu);
    t.nu_start *= std::exp((t.cluster == 0 ? 0.03 : -0.03) * P / truth.isotropic.B_star(nu));
    std::vector<double> misfit(static_cast<std::size_t>(block.rows()));
    ASSERT_TRUE(block.evaluate(x.data(), misfit.data(), nullptr));
    EXPECT_TRUE(integrate<double>(t, truth, Rung::memory, Coupling::energy, options.max_step,
                                  [&](std::size_t i, const LawState<double>& y) {
                                    EXPECT_NEAR(misfit[i], y.P - t.rows[i].data.P, 1e-9 * y.P) << t.test;
                                  }));
  }
}

TEST(MemoryFit, CalibrationFindsItWhereTheLawsItNeedsAre) {
  SyntheticOptions few = of_memory();
  few.densities = {0.70, 0.74};
  const Calibration calibration = calibrate(testing::synthetic_dataset(memory_truth(), few), {}, {});
  EXPECT_FALSE(has_values(calibration.law, "memory"));
  const Estimate& G = calibration.law.estimates[parameter_index("memory.G")];
  EXPECT_EQ(G.status, Status::not_identified);
  EXPECT_NE(G.note.find("shear by D2 at more densities"), std::string::npos) << G.note;
  for (const char* name : {"memory.m", "memory.a_P"})
    EXPECT_EQ(calibration.law.estimates[parameter_index(name)].status, Status::fixed) << name;
}

TEST(MemoryFit, SlopesAreFiniteAtAReversal) {
  // (s - s_r)/Delta = 0 to a power below one: there shear is elastic, whatever the exponent.
  using Dual = ceres::Jet<double, 1>;
  LawParameters<Dual> p = cast<Dual>(memory_truth());
  p.memory.m.v(0) = 1;
  const LawDirection d = law_direction(direction_of(Mode::D2));
  const Deviator<double> N = d.N;
  LawState<double> y{0.02, 0.16 * 0.02 * N, 0.12 * N, 0.16 * N, -0.9 * N};
  y.s_r = y.sigma / y.P;
  const LawState<Dual> dual{Dual(y.P), y.sigma.cast<Dual>(), y.F.cast<Dual>(), y.s_r.cast<Dual>(), y.E};
  const LawState<Dual> r = law_rate(p, Rung::memory, Coupling::energy, dual, 0.7, d);
  EXPECT_EQ(r.P.v(0), 0);
  for (const Dual& x : r.sigma) EXPECT_EQ(x.v(0), 0);
  for (const Dual& x : r.F) EXPECT_EQ(x.v(0), 0);
}

TEST(MemoryFit, ASegmentThatTurnsBackStartsFromItsReversal) {
  testing::SyntheticDataset data(memory_truth(), of_memory());
  auto tests = data.records();
  tests.push_back(data.test("cycle", 9, 0.72,
                            {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.1),
                             testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.1, true),
                             testing::synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.74)}));
  int found = 0;
  for (const Trajectory& t : memory_trajectories(tests)) {
    if (t.test != "cycle") continue;
    ++found;
    const Deviator<double> s = t.start.sigma / t.start.P, N = law_direction(direction_of(Mode::D2)).N;
    if (t.segment == 0) {
      EXPECT_TRUE(t.start.s_r.isZero(0));
      EXPECT_TRUE(t.start.E.isZero(0));
    }
    if (t.segment == 1) {
      EXPECT_LE((t.start.s_r - s).norm(), 1e-15);
      EXPECT_NEAR(t.start.E.dot(N), 1 - std::exp(-0.1 / kStrainMemory), 1e-9);
    }
    if (t.segment == 2) {
      EXPECT_GT((t.start.s_r - s).norm(), 0.1) << "carried on";
      EXPECT_NEAR(t.start.E.dot(N), -1 + (2 - std::exp(-0.1 / kStrainMemory)) * std::exp(-0.1 / kStrainMemory), 1e-9);
    }
  }
  EXPECT_EQ(found, 3);
}

}  // namespace
}  // namespace grainlaw::fit
