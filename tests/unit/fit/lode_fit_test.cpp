#include "fit/stages/lode_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/calibrate.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

using testing::synthetic_segment;

LawParameters<double> lode_truth() {
  LawParameters<double> p = testing::synthetic_truth();
  p.lode = {0.03, 0.9};
  return p;
}

testing::SyntheticOptions few_densities() {
  testing::SyntheticOptions options;
  options.densities = {0.68, 0.74, 0.80};
  options.rows = 40;
  return options;
}

/// D2 data, and with them D3 at two densities.
std::vector<TestRecord> with_D3(const LawParameters<double>& law) {
  testing::SyntheticDataset data(law, few_densities());
  std::vector<TestRecord> tests = data.records();
  for (const std::uint64_t seed : few_densities().seeds) {
    for (const double nu : {0.70, 0.80})
      tests.push_back(data.test(fmt::format("d3-{}-s{}", nu, seed), seed, nu,
                                {synthetic_segment(Mode::D3, ExtentKind::eps_dev, 0.3)}));
  }
  return tests;
}

TEST(LodeFit, SeparatesShearAtConstantVolumeByItsLodeAngle) {
  testing::SyntheticDataset data(lode_truth(), few_densities());
  std::vector<TestRecord> tests = with_D3(lode_truth());
  tests.push_back(data.test("uni", 1, 0.70, {synthetic_segment(Mode::UNI, ExtentKind::target_nu, 0.75)}));
  tests.push_back(data.test(
      "d2-d3", 1, 0.72,
      {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.1), synthetic_segment(Mode::D3, ExtentKind::eps_dev, 0.1)}));
  const auto all = trajectories_of(check_and_sort(tests), lode_truth().isotropic.pressure.nu_c, {});
  const ByLodeAngle sorted = by_lode_angle(all);
  EXPECT_EQ(sorted.others.size(), 5u) << "four D3, and the second segment of d2-d3";
  EXPECT_EQ(sorted.others.size() + sorted.reference.size(), all.size());
  for (const Trajectory& t : sorted.others) EXPECT_TRUE(t.test.starts_with("d3") || t.segment == 1) << t.test;
  const ByLodeAngle alone = by_lode_angle(sorted.others);
  EXPECT_TRUE(alone.others.empty());
  EXPECT_EQ(alone.reference.size(), 5u) << "D3 is the law's shear where it is the only one";
}

TEST(LodeFit, GivesBackWhatMadeTheData) {
  LawParameters<double> law = lode_truth();
  law.lode = {};
  const auto all = trajectories_of(check_and_sort(with_D3(lode_truth())), lode_truth().isotropic.pressure.nu_c, {});
  const StageFit fit = run_stage(lode_stage(by_lode_angle(all).others, {}), law, {}, {});
  EXPECT_TRUE(fit.stage.converged) << fit.stage.termination;
  EXPECT_NEAR(law.lode.stress_ratio, 0.03, 1e-6);
  EXPECT_NEAR(law.lode.fabric, 0.9, 1e-5);
}

TEST(LodeFit, LeavesTheLawOfD2Alone) {
  const LawParameters<double> law = lode_truth();
  const Calibration without = calibrate(testing::synthetic_dataset(law, few_densities()), {}, {});
  const Calibration with = calibrate(with_D3(law), {}, {});
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (name.starts_with("lode.")) {
      EXPECT_EQ(without.law.estimates[i].status, Status::fixed) << name;
      EXPECT_NE(without.law.estimates[i].note.find("add D3"), std::string::npos) << "names the remedy";
      EXPECT_EQ(*fields(without.law.parameters)[i], 0);
      EXPECT_EQ(with.law.estimates[i].status, Status::fitted) << name;
      EXPECT_NEAR(*fields(with.law.parameters)[i], *fields(law)[i], 0.02 * *fields(law)[i]) << name;
    } else {
      EXPECT_EQ(*fields(with.law.parameters)[i], *fields(without.law.parameters)[i]) << name;
    }
  }
}

}  // namespace
}  // namespace grainlaw::fit
