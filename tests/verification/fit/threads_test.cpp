// The digits of a calibration do not depend on the number of threads.

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "fit/calibrate.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

TEST(FitThreads, SameBits) {
  testing::SyntheticOptions options;
  options.densities = {0.68, 0.72, 0.80};
  options.rows = 30;
  options.noise_s = 0.01;
  options.noise_F = 0.005;
  options.noise_P = 0.005;
  const std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  CalibrationOptions one;
  const Calibration a = calibrate(tests, one, {});
  for (const int threads : {2, 3, 8}) {
    CalibrationOptions many;
    many.threads = threads;
    const Calibration b = calibrate(tests, many, {});
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(*fields(a.law.parameters)[i]),
                std::bit_cast<std::uint64_t>(*fields(b.law.parameters)[i]))
          << parameter_table()[i].name << " with " << threads << " threads";
    }
    EXPECT_EQ(a.law.covariance, b.law.covariance) << threads;
    for (std::size_t s = 0; s < a.stages.size(); ++s) EXPECT_EQ(a.stages[s].iterations, b.stages[s].iterations);
  }
}

}  // namespace
}  // namespace grainlaw::fit
