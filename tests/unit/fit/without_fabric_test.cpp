// What is left of a calibration where nobody measured the fabric, counted contacts, or both.
#include <gtest/gtest.h>

#include <cmath>

#include "fit/calibrate.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

std::vector<TestRecord> data_set(bool fabric, bool contacts) {
  testing::SyntheticOptions options;
  options.rows = 60;
  options.sequences = false;
  options.dilatancy_strain = 0.03;
  options.noise_P = options.noise_s = options.noise_F = options.noise_C = 2e-3;
  std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  for (TestRecord& test : tests) {
    for (Observation& row : test.rows) {
      if (!fabric) {
        row.fabric.tensor.setConstant(Observation::undefined);
        row.F_v = row.F_dev = row.F_par = Observation::undefined;
      }
      if (!contacts) row.C_star = row.C = row.C_r = row.rattler_fraction = row.mean_overlap = Observation::undefined;
    }
  }
  return tests;
}

Calibration calibrated(bool fabric, bool contacts) { return calibrate(data_set(fabric, contacts), {}, {}); }

const Estimate& of(const Calibration& calibration, const char* name) {
  return calibration.law.estimates[parameter_index(name)];
}

TEST(WithoutFabric, PressureAndStressRatioAreFitted) {
  const Calibration without = calibrated(false, false);
  const LawParameters<double> truth = testing::synthetic_truth(), &law = without.law.parameters;
  EXPECT_TRUE(without.law.converged);
  EXPECT_EQ(calibrated_rungs(without.law), std::vector{Rung::reduced});
  for (const double nu : {0.68, 0.70, 0.74, 0.78, 0.82}) {
    EXPECT_NEAR(law.isotropic.P_star(nu) / truth.isotropic.P_star(nu), 1, 0.005)
        << nu;                                                                    // C is that of the truth, up to nu_c
    EXPECT_NEAR(law.steady.P_star(nu) / truth.steady.P_star(nu), 1, 0.04) << nu;  // whose two nu_c differ by .002
    EXPECT_NEAR(law.stress_ratio_max.value(nu, law.shear_nu_c) / truth.stress_ratio_max.value(nu, truth.shear_nu_c), 1,
                0.03)
        << nu;
  }
  EXPECT_EQ(of(without, "pressure.p0").status, Status::fitted);
  EXPECT_TRUE(std::isfinite(of(without, "stress_ratio_max.Q_c").standard_error));
  EXPECT_EQ(of(without, "coordination.C1").status, Status::fixed);
  EXPECT_EQ(of(without, "rattlers.phi_c").value,
            parameter_table()[parameter_index("rattlers.phi_c")].published.value());
  EXPECT_EQ(of(without, "coordination.nu_c").status, Status::tied);
  EXPECT_EQ(law.isotropic.coordination.nu_c, law.isotropic.pressure.nu_c);
  EXPECT_EQ(of(without, "coordination.nu_c").standard_error, of(without, "pressure.nu_c").standard_error);
}

TEST(WithoutFabric, TheRestSaysWhichColumnsItNeeds) {
  const Calibration without = calibrated(false, false);
  for (const char* name : {"fabric_max.Q_c", "fabric_rate.Q_c", "anisotropy.a2", "memory.G", "memory.lambda"}) {
    EXPECT_EQ(of(without, name).status, Status::not_identified) << name;
    EXPECT_NE(of(without, name).note.find("add the columns fabric_xx ... fabric_xy"), std::string::npos)
        << of(without, name).note;
  }
  EXPECT_NE(of(without, "fabric.g3").note.find("C_star and rattler_fraction"), std::string::npos);
  EXPECT_NE(of(without, "overlap.D").note.find("mean_overlap"), std::string::npos);
  for (const Stage& stage : without.stages) {
    for (const TestResidual& test : stage.tests) EXPECT_TRUE(std::isfinite(test.rms)) << stage.name;
  }
}

// Each of the two can be missing alone.
TEST(WithoutFabric, ContactsAloneServeTheDensityLaws) {
  const Calibration counted = calibrated(false, true), full = calibrated(true, true);
  for (const char* name : {"coordination.C1", "coordination.nu_c", "rattlers.phi_v", "steady_pressure.nu_c"}) {
    EXPECT_EQ(of(counted, name).value, of(full, name).value) << name;  // to the last bit
  }
  EXPECT_NE(of(counted, "fabric.g3").note.find("fabric_xx"), std::string::npos);
  EXPECT_EQ(calibrated_rungs(counted.law), std::vector{Rung::reduced});
}

TEST(WithoutContacts, FabricServesTheEvolution) {
  const Calibration uncounted = calibrated(true, false), full = calibrated(true, true);
  EXPECT_EQ(of(uncounted, "coordination.C1").status, Status::fixed);
  EXPECT_NE(of(uncounted, "fabric.g3").note.find("C_star"), std::string::npos);
  const auto F_max = [](const Calibration& c) {
    return c.law.parameters.fabric_max.value(0.74, c.law.parameters.shear_nu_c);
  };
  EXPECT_NEAR(F_max(uncounted) / F_max(full), 1, 0.01);
}

TEST(WithoutFabric, SomeTestsMayGoWithout) {
  std::vector<TestRecord> mixed = data_set(true, true);
  const std::vector<TestRecord> bare = data_set(false, false);
  std::size_t shears = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    if (is_pure_shear(mixed[i]) && shears++ % 5 == 0) mixed[i] = bare[i];
  }
  const Calibration calibration = calibrate(mixed, {}, {});
  EXPECT_TRUE(calibration.law.converged);
  EXPECT_EQ(of(calibration, "fabric_max.Q_c").status, Status::fitted);
  const LawParameters<double> truth = testing::synthetic_truth(), &law = calibration.law.parameters;
  EXPECT_NEAR(law.fabric_max.value(0.74, law.shear_nu_c) / truth.fabric_max.value(0.74, truth.shear_nu_c), 1, 0.05);
}

}  // namespace
}  // namespace grainlaw::fit
