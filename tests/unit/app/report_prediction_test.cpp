#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/report/figure_data.hpp"
#include "app/report/figures.hpp"
#include "tests/support/report_scene.hpp"

namespace grainlaw::app::report {
namespace {

/// The first prediction of the scene with a band of half the measured value, evolution recommended.
struct Scene {
  chain::ReportInput input = test::report_scene();
  predict::PredictionFolder& prediction = input.predictions.front();

  Scene() {
    prediction.recommended.rung = Rung::evolution;
    for (predict::PredictedCurve& drawn : prediction.curves) {
      for (predict::PredictedRow& row : drawn.prediction.rows) {
        row.single = {0.02, 0.02, 0.02, 0.02, 0.02};
        row.mean = {0.01, 0.01, 0.01, 0.01, 0.01};
      }
    }
  }
  Figure figure() const { return prediction_figure(input, 0); }
};

Series labelled(const Panel& panel, const std::string& words) {
  const auto found = std::find_if(panel.series.begin(), panel.series.end(), [&](const Series& series) {
    return to_plain(series.label).find(words) != std::string::npos;
  });
  EXPECT_NE(found, panel.series.end()) << words;
  return found == panel.series.end() ? panel.series.front() : *found;
}

TEST(ReportPrediction, OneRungStandsOutAndTheOthersWaitForTheirToggle) {
  const Scene scene;
  const Figure figure = scene.figure();
  ASSERT_EQ(figure.panels.size(), 6U);
  for (std::size_t q = 0; q < 3; ++q) {
    const Panel& panel = figure.panels[q];
    const Series &first = labelled(panel, "evolution, recommended"), &other = labelled(panel, "reduced");
    EXPECT_TRUE(first.toggle.empty());
    EXPECT_FALSE(first.initially_hidden);
    EXPECT_EQ(first.bands.size(), 2U);
    EXPECT_EQ(other.toggle, "reduced");
    EXPECT_TRUE(other.initially_hidden);
    EXPECT_TRUE(other.bands.empty());
    for (const Series& series : panel.series) {
      const bool is_run = to_plain(series.label).starts_with("DEM");
      EXPECT_TRUE(!is_run || series.colour == Colour::grey);
    }
  }
}

TEST(ReportPrediction, PressureIsARatioWhereTheLawHasOneAllAlong) {
  Scene scene;
  const Figure ratio = scene.figure();
  const Series& law = labelled(ratio.panels[0], "evolution, recommended");
  for (std::size_t i = 0; i < law.y.size(); ++i) {
    EXPECT_NEAR(law.y[i], 0.95, 1e-12) << "what the scene's evolution is of Eq. 14";
    EXPECT_NEAR(law.bands[1][i], 2 * law.bands[0][i], 1e-12);
  }
  EXPECT_NE(to_plain(ratio.panels[0].y.label).find("ISO"), std::string::npos);
  scene.prediction.curves[1].prediction.rows[5].nu = 0.6;  // below jamming it is none
  const Panel absolute = scene.figure().panels[0];
  EXPECT_EQ(to_plain(absolute.y.label).find("ISO"), std::string::npos);
  EXPECT_LT(labelled(absolute, "evolution, recommended").y.front(), 0.1);
}

TEST(ReportPrediction, ResidualsCountInBandsOfASingleRun) {
  Scene scene;
  const TestRecord& run = scene.prediction.dem->tests.front().record;
  const auto curve_of = [&](const predict::PredictedCurve& drawn) {
    return drawn.model == Rung::evolution && drawn.seed == run.packing.seed;
  };
  const auto& rows = std::ranges::find_if(scene.prediction.curves, curve_of)->prediction.rows;
  const Series residual = labelled(scene.figure().panels[4], "evolution, recommended");
  ASSERT_EQ(residual.y.size(), run.rows.size());
  for (std::size_t i = 0; i < residual.y.size(); ++i)
    EXPECT_NEAR(residual.y[i], (run.rows[i].s_par - rows[i].s_par) / 0.02, 1e-12);
  EXPECT_EQ(scene.figure().panels[4].series.front().bands, (std::vector<std::vector<double>>{{1, 1}}));
  for (predict::PredictedCurve& drawn : scene.prediction.curves) {
    for (predict::PredictedRow& row : drawn.prediction.rows) row.single = {};
  }
  const Series difference = labelled(scene.figure().panels[4], "evolution, recommended");
  EXPECT_NEAR(difference.y[7], run.rows[7].s_par - rows[7].s_par, 1e-12) << "without a band in its own unit";
}

TEST(ReportPrediction, RunsOfTheSamePathByAnotherEngineAreShown) {
  Scene scene;
  const std::size_t runs = scene.prediction.dem->tests.size();
  predict::PredictionFolder other = scene.prediction;
  other.name += "-lammps";
  scene.prediction.dem->spec = {{"particles", 1000}};
  other.dem->spec = {{"particles", 1000}, {"engine", "lammps"}};
  for (Observation& row : other.dem->tests[0].record.rows) row.s_par += 1;
  scene.input.predictions = {scene.prediction, other};
  const auto figure = [&](std::size_t index) { return prediction_figure(scene.input, index); };
  const Panel ours = figure(0).panels[1];
  const Series &own = labelled(ours, "DEM by grainlaw"), &theirs = labelled(ours, "DEM by lammps");
  EXPECT_EQ(theirs.x, own.x);
  EXPECT_NEAR(theirs.y.back(), own.y.back() + 1, 1e-12);
  EXPECT_NE(theirs.colour, own.colour);
  EXPECT_EQ(figure(1).panels[1].series.size(), ours.series.size()) << "the other one's shows both as well";
  scene.input.predictions[1].path.nu += 0.01;
  EXPECT_EQ(figure(0).panels[1].series.size(), ours.series.size() - runs) << "not of another path";
}

TEST(ReportShear, TheRecommendedRungIsDrawnOverTheTestsOfItsPath) {
  chain::ReportInput input = test::report_scene();
  const TestRecord& shear = *std::find_if(input.tests.begin(), input.tests.end(), is_pure_shear);
  const double P = input.calibration.law.parameters.isotropic.P_star(shear.path.nu);
  chain::FittedPath fitted{shear.path,
                           {{Rung::reduced, {0, 0.1}, {P, P}, {0, 0.2}, {0, 0.1}},
                            {Rung::memory, {0, 0.1}, {P, 2 * P}, {0, 0.3}, {0, 0.15}}}};
  fitted.recommended = Rung::memory;
  input.fitted_paths = {fitted};
  const Panel stress = stress_ratio_figure(input).panels.front(),
              pressure = sheared_pressure_figure(input).panels.front();
  EXPECT_EQ(labelled(stress, "memory, recommended").y, (std::vector<double>{0, 0.3}));
  EXPECT_TRUE(labelled(stress, "memory, recommended").toggle.empty());
  EXPECT_TRUE(labelled(stress, "reduced").initially_hidden);
  EXPECT_NEAR(labelled(pressure, "memory, recommended").y[1], 2, 1e-12);
  EXPECT_EQ(labelled(fabric_figure(input).panels.front(), "memory, recommended").y[1], 0.15);
  input.fitted_paths.clear();
  input.calibrate_command = "grainlaw calibrate --dataset D -o D";
  EXPECT_NE(to_plain(stress_ratio_figure(input).caption).find(input.calibrate_command), std::string::npos);
}

TEST(ReportPrediction, PartsWithoutShearHaveALengthToo) {
  Scene scene;
  for (predict::PredictedCurve& drawn : scene.prediction.curves) {
    for (predict::PredictedRow& row : drawn.prediction.rows) row.shear_path = row.eps_dev = 0;
  }
  const Panel isotropic = scene.figure().panels[1];
  EXPECT_NE(to_plain(isotropic.x.label).find("volume fraction"), std::string::npos);
  const Series& law = labelled(isotropic, "recommended");
  EXPECT_GT(law.x.back() - law.x.front(), 0.01) << "not all at one place";
  Scene mixed;
  mixed.prediction.path.segments.push_back(mixed.prediction.path.segments.front());
  PathSegment& idle = mixed.prediction.path.segments.back();
  idle.mode = Mode::tensor;
  idle.direction.tensor = -Eigen::Matrix3d::Identity();
  idle.extent_kind = ExtentKind::target_nu;
  idle.extent = 0.85;
  for (predict::PredictedCurve& drawn : mixed.prediction.curves) {
    predict::PredictedRow row = drawn.prediction.rows.back();
    row.segment = 1;
    row.nu = 0.85;
    drawn.prediction.rows.push_back(row);
  }
  const Series both = labelled(mixed.figure().panels[1], "recommended");
  EXPECT_GT(both.x.back() - both.x[both.x.size() - 2], 0.01) << "the length of the volume's path";
}

TEST(ReportPrediction, APanelOfEachQuantityStandsUnderItsOwn) {
  Scene scene;
  for (predict::PredictedCurve& drawn : scene.prediction.curves) {
    for (predict::PredictedRow& row : drawn.prediction.rows) row.F_par = row.single.F_par = std::nan("");
  }
  for (DatasetTest& test : scene.prediction.dem->tests) {
    for (Observation& row : test.record.rows) row.F_par = std::nan("");
  }
  const Figure figure = with_data(scene.figure());
  ASSERT_EQ(figure.panels.size(), 4U);
  EXPECT_EQ(figure.columns, 2);
  EXPECT_NE(to_plain(figure.panels[2].y.label).find("P*"), std::string::npos);
  EXPECT_NE(to_plain(figure.caption).find("do not tell"), std::string::npos);
}

TEST(ReportPrediction, RunsOnFittedPackingsAreSaid) {
  Scene scene;
  EXPECT_NE(to_plain(scene.figure().caption).find("never saw"), std::string::npos);
  scene.input.tests.front().role = Role::calibration;
  scene.prediction.dem->tests.front().record.packing = scene.input.tests.front().packing;
  EXPECT_NE(to_plain(scene.figure().caption).find("some were fitted"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::app::report
