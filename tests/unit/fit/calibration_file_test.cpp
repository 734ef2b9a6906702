#include "fit/calibration_file.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/odd_law.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::fit {
namespace {

using testing::refusal;

/// Odd values in every field; no fit is needed to test files.
Calibration odd_calibration() {
  Calibration c;
  c.law = testing::odd_law();
  Stage stage;
  stage.name = "coordination";
  stage.window = "nu >= 0.675";
  stage.residuals = 7;
  stage.final_cost = 1.0 / 3;
  stage.termination = "CONVERGENCE: \"quoted\"";
  stage.converged = true;
  stage.tests.push_back({"D2-0.70-s1", "s_par", false, 5, 2, 3, 0.1, -0.2, std::nan("")});
  stage.estimates.push_back({"coordination.C1", c.law.estimates[0]});
  stage.starts = {5, 3, 0.7};
  stage.profiles.push_back(
      {"coordination.C1", "at its bound", 0.5, std::nan(""), {{0.5, 1}, {0.7, std::nan("")}}, "more of it"});
  c.stages.push_back(stage);
  ShearFit shear;
  shear.test = "D2-0.70-s1";
  shear.mode = Mode::D3;
  shear.seed = 4;
  shear.nu = 0.7;
  shear.s_max = c.law.estimates[3];
  shear.P_star = std::nan("");
  shear.steady_from = 0.15;
  shear.steady_since_F = 0.08;
  shear.steady_since_s = std::nan("");
  c.shear.push_back(shear);
  c.left_out.push_back({7, std::vector<double>(kParameterCount, 1.0 / 7), ""});
  c.left_out.push_back({9, std::vector<double>(kParameterCount, 1.0 / 9), "did not converge"});
  c.unused_tests = {"ISO-loading-s1"};
  c.warnings = {"test D2-0.70-s1: 1 of 61 rows of s_par stand out"};
  return c;
}

class CalibrationFile : public testing::TemporaryFolder {};

TEST_F(CalibrationFile, IsReadBack) {
  const Calibration c = odd_calibration();
  write_calibration(folder_ / "calibration.json", c, {}, {}, {{"command", "test"}});
  Calibration read;
  read.law.dataset_digest = c.law.dataset_digest;
  read_calibration(folder_ / "calibration.json", read);
  ASSERT_EQ(read.stages.size(), 1u);
  EXPECT_EQ(read.stages[0].window, c.stages[0].window);
  EXPECT_EQ(read.stages[0].final_cost, c.stages[0].final_cost);
  EXPECT_EQ(read.stages[0].tests[0].rms, 0.1);
  EXPECT_FALSE(read.stages[0].tests[0].in_cost);
  EXPECT_TRUE(std::isnan(read.stages[0].tests[0].max_abs_data));
  EXPECT_EQ(read.stages[0].estimates[0].name, "coordination.C1");
  ASSERT_EQ(read.shear.size(), 1u);
  EXPECT_EQ(read.shear[0].mode, Mode::D3);
  EXPECT_EQ(read.shear[0].s_max.value, c.law.estimates[3].value);
  EXPECT_TRUE(std::isnan(read.shear[0].P_star));
  EXPECT_EQ(read.shear[0].steady_from, 0.15);
  EXPECT_EQ(read.shear[0].steady_since_F, 0.08);
  EXPECT_TRUE(std::isnan(read.shear[0].steady_since_s));
  EXPECT_EQ(read.stages[0].tests[0].rows_lightened, 3);
  EXPECT_EQ(read.stages[0].starts.tried, 5);
  EXPECT_EQ(read.stages[0].starts.at_minimum, 3);
  EXPECT_EQ(read.stages[0].starts.next_cost, 0.7);
  ASSERT_EQ(read.stages[0].profiles.size(), 1u);
  const Profile& profile = read.stages[0].profiles[0];
  EXPECT_EQ(profile.parameter, "coordination.C1");
  EXPECT_EQ(profile.reason, "at its bound");
  EXPECT_EQ(profile.lower, 0.5);
  EXPECT_TRUE(std::isnan(profile.upper));
  ASSERT_EQ(profile.points.size(), 2u);
  EXPECT_EQ(profile.points[0].excess, 1);
  EXPECT_TRUE(std::isnan(profile.points[1].excess));
  EXPECT_EQ(profile.experiment, "more of it");
  ASSERT_EQ(read.left_out.size(), 2u);
  EXPECT_EQ(read.left_out[1].seed, 9u);
  EXPECT_EQ(read.left_out[1].note, "did not converge");
  EXPECT_EQ(read.left_out[1].value[0], 1.0 / 9);
  EXPECT_TRUE(std::isnan(read.left_out[1].value[parameter_index("shear.nu_c")])) << "has no error to compare with";
  EXPECT_EQ(read.unused_tests, c.unused_tests);
  EXPECT_EQ(read.warnings, c.warnings);
  Calibration of_other_data;
  of_other_data.law.dataset_digest = "of another data set";
  read_calibration(folder_ / "calibration.json", of_other_data);
  ASSERT_EQ(of_other_data.warnings.size(), c.warnings.size() + 1);
  EXPECT_NE(of_other_data.warnings.back().find("than parameters.json"), std::string::npos);
  EXPECT_NE(refusal([&] { read_calibration(put("old.json", "{}"), read); }).find("run grainlaw calibrate again"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::fit
