// Hard case F6: what the data do not contain is called not identified, never given a confident number; with and without
// noise, through the whole calibration.

#include <gtest/gtest.h>

#include <cmath>

#include "fit/calibrate.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

using testing::expect_figure;

class Identifiability : public ::testing::TestWithParam<bool> {
 protected:
  testing::SyntheticOptions options() const {
    testing::SyntheticOptions o;
    o.densities = {0.68, 0.70, 0.74, 0.80};
    o.rows = 30;
    if (GetParam()) {
      o.noise_P = 0.005;
      o.noise_s = 0.01;
      o.noise_F = 0.005;
      o.noise_C = 0.003;
      o.noise_correlation = 0.9;
      o.seed_scatter = 0.03;
    }
    return o;
  }

  /// Prints how many of the parameters are given as a number with confidence.
  static void expect_not_identified(const std::string& name_of_case, const Calibration& c,
                                    const std::vector<std::string>& laws) {
    int confident = 0;
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const std::string name = parameter_table()[i].name;
      for (const std::string& law : laws) {
        if (name.rfind(law, 0) != 0) continue;
        const Estimate& e = c.law.estimates[i];
        confident += e.status != Status::not_identified || std::isfinite(e.standard_error) || e.note.empty();
        EXPECT_EQ(e.status, Status::not_identified) << name << " = " << e.value << " +- " << e.standard_error;
        EXPECT_TRUE(std::isnan(e.standard_error)) << name;
        EXPECT_FALSE(e.note.empty()) << name;
        EXPECT_EQ(c.law.covariance.row(static_cast<Eigen::Index>(i)).norm(), 0) << name;
      }
    }
    expect_figure("F6." + name_of_case + (GetParam() ? "_noisy" : "_exact") + ".confident", confident, 0);
  }

  static void expect_identified(const Calibration& c, const std::vector<std::string>& laws) {
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const std::string name = parameter_table()[i].name;
      for (const std::string& law : laws) {
        if (name.rfind(law, 0) != 0) continue;
        EXPECT_NE(c.law.estimates[i].status, Status::not_identified) << name << c.law.estimates[i].note;
      }
    }
  }
};

TEST_P(Identifiability, F6PathEndsBeforeSaturation) {
  testing::SyntheticOptions o = options();
  o.sequences = false;
  o.shear_strain = 0.4 / 70;  // beta_s is at most 70 at these densities: strain < 0.5/beta everywhere
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), o), {}, {});
  expect_not_identified("short_path", c,
                        {"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate", "steady_", "anisotropy"});
  expect_identified(c, {"coordination", "rattlers", "pressure", "overlap", "fabric.g3"});
}

TEST_P(Identifiability, F6OneDensityOnly) {
  testing::SyntheticOptions o = options();
  o.densities = {0.72};
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), o), {}, {});
  expect_not_identified("one_density", c, {"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate", "steady_"});
  expect_identified(c, {"coordination", "rattlers", "pressure", "anisotropy.a2"});
}

TEST_P(Identifiability, F6FabricThatHardlyGrows) {
  LawParameters<double> truth = testing::synthetic_truth();
  truth.fabric_max.Q_c = 1e-5;
  const Calibration c = calibrate(testing::synthetic_dataset(truth, options()), {}, {});
  expect_not_identified("no_fabric", c, {"fabric_rate", "anisotropy"});
  expect_identified(c, {"stress_ratio_max", "stress_rate", "pressure"});
}

TEST_P(Identifiability, F6NoPathForTheCoupling) {
  testing::SyntheticOptions o = options();
  o.sequences = false;
  const Calibration c = calibrate(testing::synthetic_dataset(testing::synthetic_truth(), o), {}, {});
  expect_not_identified("no_coupling_path", c, {"anisotropy"});
  expect_identified(c, {"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"});
}

INSTANTIATE_TEST_SUITE_P(Data, Identifiability, ::testing::Bool(),
                         [](const auto& noisy) { return noisy.param ? "noisy" : "exact"; });

}  // namespace
}  // namespace grainlaw::fit
