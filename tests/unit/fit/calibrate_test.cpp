#include "fit/calibrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "fit/staged_laws.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

testing::SyntheticOptions noisy() {
  testing::SyntheticOptions options;
  options.densities = {0.68, 0.70, 0.74, 0.80};
  options.rows = 50;
  options.noise_P = 0.005;
  options.noise_s = 0.01;
  options.noise_F = 0.005;
  options.noise_C = 0.003;
  options.noise_correlation = 0.9;
  options.seed_scatter = 0.03;
  return options;
}

const Estimate& estimate(const Calibration& c, const std::string& name) {
  return c.law.estimates[parameter_index(name)];
}

TEST(Calibrate, AgreesWithItselfAboutEveryParameter) {
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), noisy()), {}, {});
  EXPECT_TRUE(c.law.converged);
  const auto value = fields(c.law.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Estimate& e = c.law.estimates[i];
    const char* name = parameter_table()[i].name;
    const bool has_error = std::isfinite(e.standard_error);
    EXPECT_EQ(has_error, e.status == Status::fitted || e.status == Status::tied) << name << " " << e.note;
    if (e.status != Status::not_identified)
      EXPECT_EQ(e.value, *value[i]) << name;
    else
      EXPECT_FALSE(e.note.empty()) << name;
    EXPECT_NEAR(c.law.covariance(k, k), has_error ? e.standard_error * e.standard_error : 0,
                1e-12 * c.law.covariance(k, k))
        << name;
  }
  EXPECT_NEAR((c.law.covariance - c.law.covariance.transpose()).norm(), 0, 1e-12 * c.law.covariance.norm());
  EXPECT_EQ(estimate(c, "shear.nu_c").status, Status::fixed);
  EXPECT_EQ(estimate(c, "anisotropy.a0").status, Status::not_identified);
  EXPECT_EQ(estimate(c, "anisotropy.a1").status, Status::tied);
  EXPECT_EQ(estimate(c, "anisotropy.a2").status, Status::fitted);
  EXPECT_EQ(c.shear.size(), 8u);
  EXPECT_NEAR(c.law.range.nu_min, 0.675, 2e-3);
  EXPECT_NEAR(c.law.range.nu_max, 0.83, 1e-9);
  EXPECT_NEAR(c.law.range.eps_dev_max, 0.30, 1e-9);
}

TEST(Calibrate, HoldsForDensitiesThatPathsEndAt) {
  testing::SyntheticOptions few = noisy();
  few.densities = {0.70, 0.75, 0.80};
  few.sequences = false;
  few.rows = 30;
  testing::SyntheticDataset made(testing::synthetic_truth(), few);
  std::vector<TestRecord> records = made.records();
  records.push_back(made.test("up", 1, 0.80,
                              {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.15),
                               testing::synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.85)}));
  EXPECT_NEAR(calibrate(records, {}, {}).law.range.nu_max, 0.85, 1e-9);
}

// a1 = (2/3)(a2 - mean over tests of a ratio): what a packing does to a1 beyond (2/3) of what it does to a2 is its deviation
// from that mean. Packings with equally many tests deviate by zero in sum.
TEST(Calibrate, TheTiedParameterVariesWithTheFreeOne) {
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), noisy()), {}, {});
  const auto row = [&](const char* name) {
    return Eigen::RowVectorXd(c.errors.influence.row(static_cast<Eigen::Index>(parameter_index(name))));
  };
  const Eigen::RowVectorXd of_ratio = row("anisotropy.a1") - 2. / 3 * row("anisotropy.a2");
  EXPECT_GT(row("anisotropy.a2").norm(), 0);
  EXPECT_GT(of_ratio.norm(), 0);
  EXPECT_NEAR(of_ratio.sum(), 0, 1e-12 * of_ratio.norm());
}

// What a packing did to one stage it did to all: parameters of different stages are correlated.
TEST(Calibrate, CovarianceJoinsTheStages) {
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), noisy()), {}, {});
  const auto k = [](const char* name) { return static_cast<Eigen::Index>(parameter_index(name)); };
  for (const auto& [a, b] : {std::pair("coordination.C1", "pressure.p0"), std::pair("pressure.p0", "overlap.D"),
                             std::pair("stress_ratio_max.Q_limit", "fabric.g3")}) {
    const double correlation =
        c.law.covariance(k(a), k(b)) / std::sqrt(c.law.covariance(k(a), k(a)) * c.law.covariance(k(b), k(b)));
    EXPECT_GT(std::abs(correlation), 1e-6) << a << " " << b;
    EXPECT_LE(std::abs(correlation), 1 + 1e-12) << a << " " << b;
  }
}

TEST(Calibrate, FindsTheCurvesOfANoisyTruthWithinItsErrors) {
  const LawParameters<double> truth = testing::synthetic_truth();
  const Calibration c = calibrate(testing::synthetic_dataset(truth, noisy()), {}, {});
  const LawParameters<double>& p = c.law.parameters;
  for (const double nu : {0.68, 0.70, 0.74, 0.80}) {
    EXPECT_NEAR(p.isotropic.P_star(nu) / truth.isotropic.P_star(nu), 1, 0.02) << nu;
    EXPECT_NEAR(p.isotropic.coordination.C_star(nu) / truth.isotropic.coordination.C_star(nu), 1, 0.005) << nu;
    EXPECT_NEAR(p.stress_ratio_max.value(nu, p.shear_nu_c) / truth.stress_ratio_max.value(nu, truth.shear_nu_c), 1,
                0.06)
        << nu;
    EXPECT_NEAR(p.fabric_max.value(nu, p.shear_nu_c) / truth.fabric_max.value(nu, truth.shear_nu_c), 1, 0.06) << nu;
  }
  const Estimate& a2 = estimate(c, "anisotropy.a2");
  EXPECT_LT(std::abs(a2.value - truth.anisotropy.a2), 4 * a2.standard_error);
  EXPECT_LT(a2.standard_error, 0.2);
}

TEST(Calibrate, StagesStandInTheirOrder) {
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), noisy()), {}, {});
  std::vector<std::string> names;
  for (const Stage& stage : c.stages) {
    names.push_back(stage.name);
    EXPECT_FALSE(stage.window.empty()) << stage.name;
    EXPECT_EQ(stage.tests.empty(), stage.name == "lode") << stage.name << ": there is no D3";
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"coordination", "rattlers", "pressure", "fabric_trace", "steady_coordination",
                                      "steady_rattlers", "steady_pressure", "shear", "stress_ratio_max", "stress_rate",
                                      "fabric_max", "fabric_rate", "evolution", "lode", "memory", "overlap"}));
}

// D of Eq. (13) is that at the nu_c that the law ends with, which the evolution moves after the stage of the pressure.
TEST(Calibrate, OverlapsReferToTheFinalJammingDensity) {
  const auto tests = testing::synthetic_dataset(testing::synthetic_truth(), noisy());
  const Calibration c = calibrate(tests, {}, {});
  double xx = 0, xd = 0;
  for (const DensitySeries& series : isotropic_series(check_and_sort(tests), {})) {
    for (const DensityPoint& p : series.points) {
      const double x = std::log(p.nu / c.law.parameters.isotropic.pressure.nu_c);
      xx += x * x, xd += x * p.mean_overlap;
    }
  }
  EXPECT_NEAR(c.law.parameters.overlap_D, xd / xx, 1e-8);
}

TEST(Calibrate, SingleCouplingKnowsOnlyA0) {
  testing::SyntheticOptions options = noisy();
  options.coupling = Coupling::single;
  LawParameters<double> truth = testing::synthetic_truth();
  truth.anisotropy.a0 = 1.4;
  CalibrationOptions single;
  single.coupling = Coupling::single;
  const Calibration c = calibrate(testing::synthetic_dataset(truth, options), single, {});
  const Estimate& a0 = estimate(c, "anisotropy.a0");
  EXPECT_EQ(a0.status, Status::fitted);
  EXPECT_LT(std::abs(a0.value - 1.4), 4 * a0.standard_error);
  for (const char* name : {"anisotropy.a1", "anisotropy.a2"}) {
    EXPECT_EQ(estimate(c, name).status, Status::not_identified);
    EXPECT_NE(estimate(c, name).note.find("not part of the law"), std::string::npos);
  }
}

TEST(Calibrate, OneSeedOneDensityRunsAndClaimsNothingItCannotKnow) {
  testing::SyntheticOptions options = noisy();
  options.densities = {0.72};
  options.seeds = {5};
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), options), {}, {});
  for (const char* name : {"pressure.p0", "coordination.C1"}) {
    EXPECT_EQ(estimate(c, name).status, Status::fitted);
    EXPECT_TRUE(std::isnan(estimate(c, name).standard_error));
    EXPECT_NE(estimate(c, name).note.find("single packing"), std::string::npos);
  }
  for (const char* name : {"stress_ratio_max.Q_c", "stress_rate.alpha", "fabric_max.Q_limit", "fabric_rate.Q_c",
                           "steady_pressure.nu_c", "steady_coordination.C1"}) {
    EXPECT_EQ(estimate(c, name).status, Status::not_identified) << name;
  }
}

TEST(Calibrate, AStageWithoutASolutionLeavesWhatIsKnown) {
  Calibration c = nothing_known();
  const std::size_t D = parameter_index("overlap.D"), g3 = parameter_index("fabric.g3");
  c.law.estimates[D] = {0.4, 0.1, Status::fitted, "", 4};
  widen(c.errors.influence, 2);
  c.errors.influence.row(static_cast<Eigen::Index>(D)).setConstant(0.05);
  StageDefinition stage;
  stage.name = "undefined";
  stage.free = {"overlap.D", "fabric.g3"};
  stage.blocks = [](const LawParameters<double>&) {
    ResidualBlock block;
    block.weight = Eigen::VectorXd::Ones(1);
    block.channels = {{"value", 0, 1, 0, 1}};
    block.evaluate = [](const double*, double*, double*) { return false; };
    return std::vector<ResidualBlock>{block};
  };
  run(stage, c, {}, {});
  EXPECT_FALSE(all_converged(c));
  EXPECT_EQ(c.law.estimates[D].status, Status::fitted);
  EXPECT_EQ(c.law.estimates[D].value, 0.4);
  EXPECT_EQ(c.errors.influence(static_cast<Eigen::Index>(D), 1), 0.05);
  EXPECT_EQ(c.law.estimates[g3].status, Status::not_identified);
  EXPECT_NE(c.law.estimates[g3].note.find("no finite solution"), std::string::npos);
}

// By strains since the start of a test, as predictions are judged: not by how far single segments went.
TEST(Calibrate, RangesAreOfStrainSinceTheStart) {
  testing::SyntheticOptions options = noisy();
  options.rows = 20;
  testing::SyntheticDataset set(testing::synthetic_truth(), options);
  const auto shear = [](double extent, bool back) {
    return testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, extent, back);
  };
  const auto compress = testing::synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.74);
  for (const bool back : {true, false}) {
    const std::vector<TestRecord> tests{set.isotropic_unloading(1),
                                        set.test("d2", 1, 0.72, {shear(0.1, false), shear(0.15, back), compress})};
    CalibrationOptions options_of_fit;
    const std::vector<TestRecord> with{tests[0], tests[1], set.test("short", 1, 0.73, {shear(0.02, false)})};
    const ValidRange range = calibrate(with, options_of_fit, {}).law.range;
    EXPECT_NEAR(range.eps_dev_max, back ? 0.1 : 0.25, 1e-9);
    EXPECT_NEAR(range.shear_path_max, 0.25, 1e-9);
  }
}

TEST(Calibrate, SpheresAreKnownOnlyWhereAllPackingsTellThem) {
  std::vector<TestRecord> tests(3);
  for (std::size_t i = 0; i < 3; ++i) tests[i].packing.seed = i / 2;  // the first two of one packing
  tests[0].packing.particles = 1000;
  EXPECT_TRUE(std::isnan(size_of(tests).spheres));
  tests[2].packing.particles = 500;
  EXPECT_EQ(size_of(tests).spheres, 1500) << "one of a packing's tests is enough";
  testing::SyntheticOptions options = noisy();
  options.densities = {0.72};
  options.seeds = {5};
  options.rows = 20;
  tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  for (TestRecord& test : tests) test.packing.particles = 0;
  const std::vector<std::string> warnings = calibrate(tests, {}, {}).warnings;
  EXPECT_TRUE(std::ranges::any_of(warnings, [](const std::string& w) { return w.find("particles") != w.npos; }));
  EXPECT_FALSE(std::ranges::any_of(warnings, [](const std::string& w) { return w.find("spheres:") != w.npos; }));
}

TEST(Calibrate, RefusesBeforeAnythingRuns) {
  std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), noisy());
  tests[2].role = Role::validation;
  EXPECT_THROW(calibrate(tests, {}, {}), InvalidInput);
  CalibrationOptions options;
  options.threads = 0;
  tests[2].role = Role::calibration;
  EXPECT_THROW(calibrate(tests, options, {}), InvalidInput);
}

TEST(Calibrate, CanBeStopped) {
  const std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), noisy());
  std::stop_source source;
  RunControl control;
  control.stop = source.get_token();
  std::set<std::string> stages;
  double so_far = 0;
  control.report = [&](const Progress& progress) {
    stages.insert(progress.stage);
    EXPECT_GE(progress.fraction, so_far);  // of the whole fit, never back
    EXPECT_LT(progress.fraction, 1);
    so_far = progress.fraction;
    if (progress.stage == "evolution") source.request_stop();
  };
  EXPECT_THROW(calibrate(tests, {}, control), Interrupted);
  EXPECT_TRUE(stages.count("coordination") == 1 && stages.count("evolution") == 1);
}

TEST(Calibrate, AStageOfWhatIsWithdrawnTakesNothingAway) {
  Calibration calibration = nothing_known();
  Stage& stage = calibration.stages.emplace_back();
  stage.converged = false;
  stage.estimates.push_back({"memory.G", {}});
  EXPECT_TRUE(all_converged(calibration)) << "its rung is left out";
  calibration.law.estimates[parameter_index("memory.G")].status = Status::fitted;
  EXPECT_FALSE(all_converged(calibration));
  stage.estimates.clear();
  EXPECT_FALSE(all_converged(calibration)) << "it says nothing";
}

}  // namespace
}  // namespace grainlaw::fit
