#include "chain/fitted_paths.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/report_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kDensity = 0.74, kStrain = 0.25;

CalibratedLaw law_with_lode() {
  CalibratedLaw law = test::report_scene().calibration.law;
  law.parameters.lode.stress_ratio = 0.1;
  law.parameters.lode.fabric = 0.6;
  for (const char* name : {"memory.G", "memory.k"})  // the memory rung is another matter
    law.estimates[parameter_index(name)].status = Status::not_identified;
  return law;
}

std::vector<TestRecord> shear_tests() {
  std::vector<TestRecord> tests;
  for (const std::uint64_t seed : {1u, 2u}) {
    for (const Mode mode : {Mode::D2, Mode::D3})
      tests.push_back(test::make_test("shear", seed, kDensity, {test::segment_of(mode, ExtentKind::eps_dev, kStrain)}));
    tests.push_back(
        test::make_test("ISO", seed, 0.82, {test::segment_of(Mode::ISO, ExtentKind::target_nu, 0.7, true)}));
  }
  return tests;
}

using FittedPathsFile = testing::TemporaryFolder;

TEST(FittedPaths, EveryShearPathOnceByEveryRungWithTheLodeAngleOfItsMode) {
  const CalibratedLaw law = law_with_lode();
  const std::vector<FittedPath> paths = fitted_paths(law, shear_tests(), {});
  ASSERT_EQ(paths.size(), 2U) << "packings share a path, isotropic paths are none";
  for (const FittedPath& fitted : paths) {
    ASSERT_EQ(fitted.curves.size(), 2U);
    const FittedCurve& reduced = fitted.curves.front();
    ASSERT_EQ(reduced.model, Rung::reduced);
    const Mode mode = fitted.path.segments.front().mode;
    const LawModuli<double> m = along(moduli_at(law.parameters, kDensity), law.parameters.lode,
                                      law_direction(direction_of(mode, "xyz", false)));
    EXPECT_NEAR(reduced.eps_dev.back(), kStrain, 1e-12);
    EXPECT_NEAR(reduced.s_par.back(), m.s_max * (1 - std::exp(-m.beta_s * kStrain)), 1e-10) << to_string(mode);
    EXPECT_NEAR(reduced.F_par.back(), m.F_max * (1 - std::exp(-m.beta_F * kStrain)), 1e-10) << to_string(mode);
    EXPECT_NEAR(reduced.P_star.back(), law.parameters.isotropic.P_star(kDensity), 1e-12);
  }
  EXPECT_GT(std::abs(paths[0].curves[0].F_par.back() - paths[1].curves[0].F_par.back()), 1e-3);
}

TEST_F(FittedPathsFile, GivesBackWhatWasWritten) {
  const CalibratedLaw law = law_with_lode();
  const std::vector<FittedPath> paths = fitted_paths(law, shear_tests(), {});
  const auto file = folder_ / "fitted_paths.json";
  EXPECT_TRUE(read_fitted_paths(file, law).empty()) << "folders of earlier programs have none";
  write_fitted_paths(file, paths, {});
  const std::vector<FittedPath> read = read_fitted_paths(file, law);
  ASSERT_EQ(read.size(), paths.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].recommended, recommended_along(law, paths[i].path));
    ASSERT_EQ(read[i].curves.size(), paths[i].curves.size());
    for (std::size_t k = 0; k < read[i].curves.size(); ++k) {
      EXPECT_EQ(read[i].curves[k].model, paths[i].curves[k].model);
      EXPECT_EQ(read[i].curves[k].eps_dev, paths[i].curves[k].eps_dev);
      EXPECT_EQ(read[i].curves[k].P_star, paths[i].curves[k].P_star);
      EXPECT_EQ(read[i].curves[k].s_par, paths[i].curves[k].s_par);
      EXPECT_EQ(read[i].curves[k].F_par, paths[i].curves[k].F_par);
    }
  }
}

TEST(FittedPaths, ADensityBelowTheLawsJammingHasNoCurve) {
  CalibratedLaw law = law_with_lode();
  law.parameters.isotropic.pressure.nu_c = kDensity + 0.01;
  for (const FittedPath& fitted : fitted_paths(law, shear_tests(), {})) EXPECT_TRUE(fitted.curves.empty());
}

}  // namespace
}  // namespace grainlaw::chain
