// What a study of settings leaves: study.json by its schema, the table, the figure.

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "app/report/figure_study.hpp"
#include "app/report/svg_figure.hpp"
#include "app/terminal/study_text.hpp"
#include "chain/studies/settings_study.hpp"
#include "model/files/schema.hpp"
#include "model/student.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

chain::SettingOutcome outcome(const std::string& name, double cost, double value) {
  const Eigen::MatrixXd psi = Eigen::MatrixXd::Constant(1, 3, 0.005);
  const chain::StudyQuantity s_par{"s_par", Eigen::VectorXd::Constant(1, value), psi, true};
  return {name, {{"rows", 20}}, {cost, 1, 2}, {1, 2, 3}, {s_par}, {}, 0.001, "memory", "a note"};
}

chain::SettingsStudy study(double cheap) {
  return chain::study_of("chain", "in words", chain::Packings::chosen, {{"rows", 40}},
                         {outcome("base", 1e9, 1), outcome("cheap", 5e8, cheap), outcome("dear", 2e9, 1.2)}, 0);
}

TEST(StudyFiles, FollowTheSchema) {
  OrderedJson document = chain::study_to_json(study(1.1));
  document["provenance"] = OrderedJson::object();
  EXPECT_NO_THROW(check_schema(Json(document), Schema::study_settings, "study.json"));
  EXPECT_EQ(document["default"]["setting"], "base");
  EXPECT_EQ(document["default"]["dominated"], false);
  using Names = std::vector<std::string>;
  EXPECT_EQ(document["settings"][2]["dominated_by"].get<Names>(), (Names{"base", "cheap"}));
  EXPECT_EQ(chain::study_to_json(study(1))["default"]["dominated_by"].get<Names>(), Names{"cheap"});
  EXPECT_TRUE(document["settings"][2]["perhaps_dominated_by"].empty());
  EXPECT_TRUE(document["settings"][2]["reached_standard_error"].is_number());
  document["settings"][0].erase("sampling");
  EXPECT_THROW(check_schema(Json(document), Schema::study_settings, "study.json"), std::exception);
}

TEST(StudyFiles, TheTableSaysWhetherTheDefaultIsDominated) {
  EXPECT_NE(study_text(study(1.1)).find("base is not dominated\n"), std::string::npos);
  EXPECT_NE(study_text(study(1)).find("base is dominated by cheap\n"), std::string::npos);
  chain::SettingsStudy toss = study(1);
  std::swap(toss.results[0].dominated_by, toss.results[0].perhaps_dominated_by);
  EXPECT_NE(study_text(toss).find("base may be dominated: cheaper and as good or better, within chance: cheap\n"),
            std::string::npos)
      << "what chance leaves open is not called undominated";
  chain::SettingsStudy bold = study(1.1);
  EXPECT_EQ(study_text(bold).find("near the energy balance's stop"), std::string::npos);
  bold.results[1].outcome.energy_residual = 0.009;
  EXPECT_NE(study_text(bold).find("near the energy balance's stop"), std::string::npos);
  chain::SettingsStudy nothing = study(1);
  nothing.results[0].reached = std::nan("");
  EXPECT_NE(study_text(nothing).find("base shows nothing to be judged by\n"), std::string::npos);
}

TEST(StudyFiles, TheFigureStarsTheDefaultAndGreysWhatIsDominated) {
  using namespace report;
  const Panel free = figure_of(study(1.1)).panels.front(), dominated = figure_of(study(1)).panels.front();
  const auto series = [](const Panel& panel, const std::string& label) {
    for (const Series& s : panel.series) {
      if (to_plain(s.label) == label) return s;
    }
    return Series{};
  };
  EXPECT_EQ(series(free, "base").marker, Marker::star);
  EXPECT_EQ(series(free, "base").colour, Colour::vermillion);
  EXPECT_EQ(series(dominated, "base").colour, Colour::grey);
  EXPECT_EQ(series(free, "dear").colour, Colour::grey);
  EXPECT_NE(series(free, "cheap").colour, Colour::grey);
  EXPECT_NE(series(free, "cheap").marker, Marker::star);
  chain::SettingsStudy bold = study(1.1);
  bold.results[1].outcome.energy_residual = 0.009;
  EXPECT_EQ(series(figure_of(bold).panels.front(), "cheap").colour, Colour::grey);
  // the shade ends where the sampling does
  const Series& shade = free.series.front();
  ASSERT_EQ(shade.bands.size(), 1u);
  for (std::size_t i = 0; i < shade.x.size(); ++i)
    EXPECT_NEAR(shade.y[i] + shade.bands[0][i], student_95(2) * 0.005 * std::sqrt(3.0), 1e-12);
  EXPECT_NE(figure_svg(figure_of(study(1.1))).find("class=\"b\""), std::string::npos);
}

TEST(StudyFiles, NoTwoSettingsOfTheFigureLookAlike) {
  using namespace report;
  std::vector<chain::SettingOutcome> outcomes{outcome("base", 1e9, 1)};
  for (int i = 0; i < 15; ++i) outcomes.push_back(outcome("cheap " + std::to_string(i), 5e8, 1.1));
  const Panel panel =
      figure_of(chain::study_of("chain", "in words", chain::Packings::chosen, {}, outcomes, 0)).panels.front();
  std::set<std::tuple<Marker, Colour, bool>> looks;
  for (const Series& s : panel.series) {
    if (s.marker != Marker::none) looks.insert({s.marker, s.colour, s.open_marker && s.marker != Marker::plus});
  }
  EXPECT_EQ(looks.size(), 16u);
}

using StudyFilesInAFolder = testing::TemporaryFolder;

// Image viewers know no CSS variables: each colour is given to them as a number first.
TEST_F(StudyFilesInAFolder, TheFigureHasItsColoursInEveryViewer) {
  const std::filesystem::path file = folder_ / "settings.svg";
  report::write_svg(file, report::figure_of(study(1.1)));
  const std::string svg = content(file);
  EXPECT_NE(svg.find("svg text { fill: #1b1b1b; fill: var(--text); }"), std::string::npos);
  EXPECT_NE(svg.find(" .k7 { color: #5c5c5c; color: var(--quiet); }"), std::string::npos);
  EXPECT_NE(svg.find("html { background: #ffffff; background: var(--ground); color: #1b1b1b; color: var(--text); "),
            std::string::npos);
  EXPECT_NE(svg.find("svg { background: #ffffff; background: var(--ground); }"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::app
