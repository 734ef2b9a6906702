#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/report/figures.hpp"
#include "tests/support/report_scene.hpp"

namespace grainlaw::app::report {
namespace {

Panel panel_of(const Figure& figure, const std::string& title) {
  for (const Panel& panel : figure.panels) {
    if (to_html(panel.title) == title) return panel;
  }
  ADD_FAILURE() << title;
  return figure.panels.front();
}

std::vector<const Series*> series_of(const Panel& panel, const std::string& label) {
  std::vector<const Series*> found;
  for (const Series& series : panel.series) {
    if (to_html(series.label) == label) found.push_back(&series);
  }
  return found;
}

/// The scene with a uniaxial cycle and D2 from the loading branch at .70.
chain::ReportInput scene_of_modes() {
  chain::ReportInput input = test::report_scene();
  std::mt19937_64 generator(3);
  TestRecord cycle = test::make_test("UNI-cycle", 1, 0.64,
                                     {test::segment_of(Mode::UNI, ExtentKind::target_nu, 0.82),
                                      test::segment_of(Mode::UNI, ExtentKind::target_nu, 0.64, true)});
  TestRecord shear = test::make_test("D2-loading", 1, 0.70, {test::segment_of(Mode::D2, ExtentKind::eps_dev, 0.25)});
  cycle.path.branch = shear.path.branch = Branch::loading;
  for (TestRecord* test : {&cycle, &shear}) {
    test::fill_rows(*test, input.calibration.law.parameters, 90, generator);
    input.tests.push_back(*test);
    input.costs.push_back({});
  }
  return input;
}

TEST(ReportModes, DecompressionGoesOnInTimeFromTheCompressionOfItsPacking) {
  const chain::ReportInput input = scene_of_modes();
  const Panel time = panel_of(modes_figure(input), "Fig. 1");
  const auto isotropic = series_of(time, "ISO");
  ASSERT_EQ(isotropic.size(), 4U) << "two packings, two branches";
  for (std::size_t k = 0; k < isotropic.size(); k += 2) {
    const Series &loading = *isotropic[k], &unloading = *isotropic[k + 1];
    EXPECT_LT(loading.y.front(), loading.y.back());
    EXPECT_GT(unloading.y.front(), unloading.y.back());
    EXPECT_DOUBLE_EQ(unloading.x.front(), loading.x.back());
  }
  ASSERT_EQ(series_of(time, "UNI").size(), 1U);
  EXPECT_DOUBLE_EQ(series_of(time, "UNI").front()->x.back(),
                   1e3 * input.tests[input.tests.size() - 2].rows.back().time);
}

TEST(ReportModes, BranchesAreToldApart) {
  const chain::ReportInput input = scene_of_modes();
  const Figure figure = modes_figure(input);
  for (const char* title : {"Figs. 4, 6", "Fig. 7"}) {
    const Panel panel = panel_of(figure, title);
    for (const char* mode : {"ISO", "UNI"}) {
      const auto unloading = series_of(panel, mode), loading = series_of(panel, std::string(mode) + ", loading");
      const std::size_t packings = mode == std::string("ISO") ? 2 : 1;
      ASSERT_EQ(unloading.size(), packings) << title << mode;
      ASSERT_EQ(loading.size(), packings) << title << mode;
      EXPECT_EQ(unloading.front()->line, Line::solid);
      EXPECT_EQ(loading.front()->line, Line::dotted);
      EXPECT_GT(unloading.front()->x.front(), unloading.front()->x.back()) << "it expands";
      EXPECT_LT(loading.front()->x.front(), loading.front()->x.back());
    }
    const auto published = series_of(panel, "ISO, published");
    ASSERT_EQ(published.size(), 1U);
    EXPECT_TRUE(series_of(panel, "UNI, published").empty()) << "nothing of ours stands beside it";
  }
}

TEST(ReportModes, ScaledPressureIsThatOfEquation15) {
  chain::ReportInput input = scene_of_modes();
  fit::Description uniaxial{"UNI", {}};  // as calibration.json has it
  fit::Stage pressure;
  pressure.name = "pressure";
  pressure.estimates = {{"pressure.nu_c", test::estimate_of(0.66, 1e-4)}};
  uniaxial.calibration.stages = {pressure};
  input.modes.descriptions = {uniaxial};
  const Panel panel = panel_of(modes_figure(input), "Fig. 10");
  const LawParameters<double> p = published_parameters();  // what the scene was made of
  for (const Series* series : series_of(panel, "ISO")) {
    for (std::size_t i = 0; i < series->x.size(); ++i) {
      const double x = series->x[i];
      EXPECT_NEAR(series->y[i], p.isotropic.pressure.p0 * x * (1 - p.isotropic.pressure.gamma_p * x),
                  0.06 * series->y[i] + 1e-9);
    }
  }
  const auto steady = series_of(panel, "steady D2, DEM (mean per run)");
  ASSERT_EQ(steady.size(), 1U);
  for (std::size_t i = 0; i < steady.front()->x.size(); ++i) {
    const double x = steady.front()->x[i];
    EXPECT_NEAR(steady.front()->y[i], p.steady.pressure.p0 * x * (1 - p.steady.pressure.gamma_p * x), 1e-12);
  }
  const auto cycle = series_of(panel, "UNI");
  ASSERT_EQ(cycle.size(), 1U);
  const std::vector<Observation>& rows = input.tests[input.tests.size() - 2].rows;
  for (const double x : cycle.front()->x)
    EXPECT_TRUE(std::ranges::any_of(rows, [&](const Observation& row) { return std::log(row.nu / 0.66) == x; }))
        << "from its own jamming density";
  const auto published = series_of(panel, "UNI, published");
  ASSERT_EQ(published.size(), 1U);
  const Pressure<double> of_UNI = published_parameters("UNI").isotropic.pressure;
  const double x = published.front()->x.back();
  EXPECT_DOUBLE_EQ(published.front()->y.back(), of_UNI.p0 * x * (1 - of_UNI.gamma_p * x));
}

TEST(ReportModes, ShearIsShownWhereItStartsFromBothBranches) {
  const Figure figure = modes_figure(scene_of_modes());
  ASSERT_EQ(figure.panels.size(), 6U);
  for (const char* title : {"Fig. 5", "Fig. 8"}) {
    const Panel panel = panel_of(figure, title);
    ASSERT_EQ(panel.series.size(), 3U) << "two packings from the unloading branch, one from the other";
    int dotted = 0;
    for (const Series& series : panel.series) {
      EXPECT_EQ(series.colour, panel.series.front().colour) << "one density";
      dotted += series.line == Line::dotted ? 1 : 0;
    }
    EXPECT_EQ(dotted, 1);
  }
  EXPECT_EQ(modes_figure(test::report_scene()).panels.size(), 4U) << "no loading branch, nothing to set beside";
}

}  // namespace
}  // namespace grainlaw::app::report
