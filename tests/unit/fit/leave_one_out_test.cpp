#include "fit/leave_one_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

std::vector<TestRecord> noisy_tests(const std::vector<std::uint64_t>& seeds) {
  testing::SyntheticOptions options;
  options.densities = {0.68, 0.72, 0.80};
  options.seeds = seeds;
  options.rows = 12;
  options.noise_P = options.noise_s = options.noise_F = 0.003;
  options.noise_C = 0.003;
  return testing::synthetic_dataset(testing::synthetic_truth(), options);
}

/// Long steps, for speed.
CalibrationOptions coarse() {
  CalibrationOptions options;
  options.max_step = 4e-3;
  return options;
}

TEST(LeaveOneOut, JackknifeErrorByItsFormula) {
  std::vector<LeftOut> fits;
  for (const double value : {1.0, 2.0, 6.0}) fits.push_back({0, {value}, ""});
  EXPECT_NEAR(jackknife_error(fits, 0), std::sqrt(2. / 3 * (4 + 1 + 9)), 1e-12);
  EXPECT_EQ(furthest(fits, 0, 2.5)->value[0], 6);
  fits[1].value[0] = std::nan("");
  EXPECT_TRUE(std::isnan(jackknife_error(fits, 0)));
  EXPECT_EQ(furthest(fits, 0, 5)->value[0], 1);
}

TEST(LeaveOneOut, IsTheCalibrationOfTheRestAndConfirmsTheStatedErrors) {
  const std::vector<TestRecord> tests = noisy_tests({1, 2, 3});
  const Calibration all = calibrate(tests, coarse(), {});
  const std::vector<LeftOut> fits = leave_one_out(tests, coarse(), {});
  ASSERT_EQ(fits.size(), 3u);
  EXPECT_EQ(fits[1].seed, 2u);
  const Calibration rest = calibrate(noisy_tests({1, 3}), coarse(), {});
  for (const char* name : {"pressure.p0", "stress_ratio_max.Q_c"}) {
    const std::size_t i = parameter_index(name);
    EXPECT_EQ(fits[1].value[i], *fields(rest.law.parameters)[i]) << name;
  }
  for (const char* name : {"coordination.C1", "pressure.p0", "stress_ratio_max.Q_limit", "stress_rate.Q_limit"}) {
    const std::size_t i = parameter_index(name);
    EXPECT_NEAR(jackknife_error(fits, i) / all.law.estimates[i].standard_error, 1, 0.3) << name;
  }
}

TEST(LeaveOneOut, NothingIsLeftOfASinglePacking) { EXPECT_TRUE(leave_one_out(noisy_tests({4}), {}, {}).empty()); }

TEST(LeaveOneOut, SaysWhatAPartOfTheDataLacks) {
  std::vector<TestRecord> tests = noisy_tests({1, 2});
  std::erase_if(tests, [](const TestRecord& t) { return t.packing.seed == 2 && is_isotropic_unloading(t); });
  const std::vector<LeftOut> fits = leave_one_out(tests, coarse(), {});
  ASSERT_EQ(fits.size(), 2u);
  EXPECT_NE(fits[0].note.find("isotropic unloading"), std::string::npos) << fits[0].note;
  EXPECT_TRUE(std::isnan(fits[0].value[parameter_index("pressure.p0")]));
  EXPECT_EQ(fits[1].note, "");
}

}  // namespace
}  // namespace grainlaw::fit
