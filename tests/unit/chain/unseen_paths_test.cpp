#include "chain/unseen_paths.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/report_scene.hpp"

namespace grainlaw::chain {
namespace {

Rehearsal rehearsal_of(const std::string& name, const Path& path, double error) {
  Rehearsal rehearsal;
  rehearsal.name = name;
  rehearsal.path = path;
  rehearsal.traits = traits_of(resolve(path));
  rehearsal.kind = kind_of(rehearsal.traits);
  rehearsal.packings = 3;
  for (const Rung rung : kRungs) {
    const double e = rung == Rung::reduced ? error : 2 * error;
    rehearsal.rungs.push_back({rung, {90, 1e-4 * e * e, 0, e}, {90, e * e, 0, e}, {90, 4 * e * e, 0, e}});
  }
  return rehearsal;
}

TEST(UnseenPaths, PredictionsAreReadOfTheirComparisonAndRehearsalsOfTheLaw) {
  ReportInput input = test::report_scene();
  CalibratedLaw& law = input.calibration.law;
  const Path shear = test::make_test("D2", 1, 0.71, {test::segment_of(Mode::D2, ExtentKind::eps_dev, 0.2)}).path;
  law.rehearsals = {rehearsal_of("again", input.predictions.front().path, 0.3), rehearsal_of("shear", shear, 0.04)};
  const std::vector<PathError> errors = errors_on_unseen_paths(input);
  ASSERT_EQ(errors.size(), 7U)
      << "two predictions by two rungs, one rehearsal by three; a predicted path is none twice";
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(errors[i].prediction, &input.predictions[i / 2]);
    EXPECT_EQ(errors[i].error, (std::array{0.028, 0.028, 0.028}));
    EXPECT_EQ(errors[i].recommended, errors[i].rung == Rung::reduced) << "what the prediction's file says";
  }
  const PathError& rehearsed = errors[4];
  EXPECT_EQ(rehearsed.path, "shear");
  EXPECT_EQ(rehearsed.prediction, nullptr);
  EXPECT_EQ(rehearsed.kind, PathKind::monotone);
  const double B = law.parameters.isotropic.B_star(0.71), P = law.parameters.isotropic.P_star(0.71);
  EXPECT_NEAR(rehearsed.error[0], 1e-2 * 0.04 * B / P, 1e-12) << "an error of strain, relative to the pressure";
  EXPECT_NEAR(rehearsed.error[1], 0.04, 1e-12);
  EXPECT_NEAR(rehearsed.error[2], 0.08, 1e-12);
  EXPECT_TRUE(std::isnan(rehearsed.in_band[0]));
  EXPECT_TRUE(rehearsed.recommended) << "it does best on the other rehearsal";
}

TEST(UnseenPaths, OverPathsStandsTheRootMeanSquareBetweenBestAndWorst) {
  std::vector<PathError> errors(3);
  errors[0].error = {0.03, PathError::kNone, 0.1};
  errors[1].error = {0.04, 0.2, 0.1};
  errors[2].error = {9, 9, 9};
  const auto keep = [&](const PathError& entry) { return &entry != &errors[2]; };
  const ErrorOverPaths P = error_over(errors, Rehearsed::P_star, keep), s = error_over(errors, Rehearsed::s_par, keep);
  EXPECT_EQ(P.paths, 2);
  EXPECT_NEAR(P.rms, std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2), 1e-15);
  EXPECT_EQ(P.least, 0.03);
  EXPECT_EQ(P.largest, 0.04);
  EXPECT_EQ(s.paths, 1) << "a path without the quantity is none";
  EXPECT_EQ(error_over(errors, Rehearsed::F_par, [](const PathError&) { return false; }).paths, 0);
}

}  // namespace
}  // namespace grainlaw::chain
