#include <gtest/gtest.h>

#include <cmath>

#include "app/report/page.hpp"
#include "app/report/svg_figure.hpp"
#include "tests/support/well_formed.hpp"

namespace grainlaw::app::report {
namespace {

Figure one_panel(Series series) {
  Figure figure;
  figure.id = "one";
  figure.title = "One panel";
  figure.description = "A line.";
  Panel panel;
  panel.x.label = notation("{x} [–]");
  panel.y.label = notation("{y} [–]");
  panel.series = {std::move(series)};
  figure.panels = {panel};
  return figure;
}

Series line_of(std::vector<double> x, std::vector<double> y) {
  Series series;
  series.label = plain("line");
  series.x = std::move(x);
  series.y = std::move(y);
  series.line = Line::solid;
  series.marker = Marker::circle;
  return series;
}

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(ReportFigure, UndefinedPointsAreCountedAndBreakTheLine) {
  const double nan = std::nan("");
  const RenderedFigure rendered = render_svg(one_panel(line_of({0, 1, 2, 3, 4, INFINITY}, {0, 1, nan, 3, 4, 5})));
  EXPECT_EQ(rendered.undefined_points, 2);
  EXPECT_EQ(rendered.svg.find("nan"), std::string::npos);
  EXPECT_EQ(rendered.svg.find("inf"), std::string::npos);
  EXPECT_EQ(test::first_markup_error(rendered.svg), "");
  // four circles and one more in the legend, each of two arcs
  EXPECT_EQ(count(rendered.svg, " 0 1 0 "), 2 * (4 + 1));
}

TEST(ReportFigure, BandsStretchTheAxisAndBreakWhereTheyAreUndefined) {
  Series series = line_of({0, 1, 2, 3, 4}, {1, 1, 1, 1, 1});
  EXPECT_EQ(count(render_svg(one_panel(series)).svg, "class=\"band\""), 0);
  series.bands = {{5, 5, std::nan(""), 5, 5}, {1, 1, 1, 1, 1}};
  const RenderedFigure rendered = render_svg(one_panel(series));
  EXPECT_EQ(count(rendered.svg, "class=\"band\""), 2);
  EXPECT_EQ(count(rendered.svg, "z\" fill=\"currentColor\" fill-opacity"), 2);
  const std::size_t wide = rendered.svg.find("class=\"band\" d=\"") + 16;
  const std::string path = rendered.svg.substr(wide, rendered.svg.find('"', wide) - wide);
  EXPECT_EQ(count(path, "M"), 2) << "one piece on either side of the gap: " << path;
  EXPECT_EQ(count(path, "L"), 6);
  EXPECT_NE(rendered.svg.find("<text"), std::string::npos);
  EXPECT_EQ(rendered.svg.find("nan"), std::string::npos);
  EXPECT_EQ(rendered.undefined_points, 0) << "the points themselves are";
  // an axis from 0 to 2 would not reach the band's edge, 6
  EXPECT_NE(rendered.svg.find(">6<"), std::string::npos);
}

TEST(ReportFigure, ALogarithmicAxisLeavesOutWhatIsNotPositive) {
  Figure figure = one_panel(line_of({0, 1, 2, 3}, {1e-3, 0, -1, 1e-1}));
  figure.panels[0].y.logarithmic = true;
  EXPECT_EQ(render_svg(figure).undefined_points, 2);
}

TEST(ReportFigure, SymbolsBeyondAFixedRangeAreCounted) {
  Figure figure = one_panel(line_of({0, 1, 2, 3}, {0, 1, 2, 300}));
  figure.panels[0].y.from = 0;
  figure.panels[0].y.to = 2;
  EXPECT_EQ(render_svg(figure).outside_points, 1);
}

TEST(ReportFigure, NothingToDrawIsStillAFigure) {
  for (const bool logarithmic : {false, true}) {
    Figure figure = one_panel(line_of({}, {}));
    figure.panels[0].y.logarithmic = logarithmic;
    EXPECT_EQ(test::first_markup_error(render_svg(figure).svg), "");
  }
  Figure none;
  none.id = "none";
  EXPECT_EQ(test::first_markup_error(render_svg(none).svg), "");
}

TEST(ReportFigure, EnormousNumbersStayFinite) {
  const RenderedFigure rendered = render_svg(one_panel(line_of({0, 1, 2}, {-1e308, 1e308, 1e-308})));
  EXPECT_EQ(rendered.svg.find("nan"), std::string::npos);
  EXPECT_EQ(rendered.svg.find("inf"), std::string::npos);
}

TEST(ReportFigure, PanelsShareAxesOnRequest) {
  Figure figure = one_panel(line_of({0, 1}, {0, 1}));
  figure.panels.push_back(figure.panels[0]);
  figure.panels[1].series[0].y = {0, 10};
  figure.columns = 2;
  figure.shared_axes = true;
  const std::string svg = render_svg(figure).svg;
  EXPECT_EQ(count(svg, ">10</text>"), 1);    // numbers on the outer panel only
  EXPECT_EQ(count(svg, ">line</text>"), 1);  // one entry in the legend
}

// Of each "`words`NUMBER`between`NUMBER" the second number.
std::vector<double> second_numbers(const std::string& text, const std::string& words, const std::string& between) {
  std::vector<double> numbers;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    numbers.push_back(std::stod(text.substr(text.find(between, at + words.size()) + between.size())));
  return numbers;
}

// A symbol lies at the same height above its frame in every one of many rows of panels.
TEST(ReportFigure, DataStayInTheirPanelHoweverFarDown) {
  Series series = line_of({0, 1}, {0, 1});
  series.line = Line::none;
  Figure figure = one_panel(series);
  figure.panels.assign(30, figure.panels[0]);
  figure.columns = 1;
  const std::string svg = render_svg(figure).svg;
  const std::vector<double> top = second_numbers(svg, "<rect class=\"axis\" x=\"", "\" y=\""),
                            symbol = second_numbers(svg, "<title>line</title><path d=\"M", " ");
  ASSERT_EQ(top.size(), 30u);
  ASSERT_EQ(symbol.size(), 30u);
  for (std::size_t i = 0; i < top.size(); ++i) EXPECT_NEAR(symbol[i] - top[i], symbol[0] - top[0], 0.02) << i;
}

TEST(ReportFigure, HostileLabelsAndNamesStayText) {
  const std::string hostile = "</script><script>alert(1)</script>\"><img src=x onerror=alert(1)> & \xE2\x80\xA8 \x01";
  Figure figure = one_panel(line_of({0, 1}, {0, 1}));
  figure.title = figure.description = hostile;
  figure.sources = {hostile};
  figure.caption = plain(hostile);
  figure.panels[0].title = plain(hostile);
  figure.panels[0].series[0].label = plain(hostile);
  Cell barred(hostile);
  barred.bar = Bar{0, 0.5, 1, 0.2};
  Table table{hostile, {{plain(hostile)}, {plain(hostile)}}, {{plain(hostile), barred}}, hostile};
  table.notes = {hostile};
  const Tiles tiles{hostile, {{plain(hostile), plain(hostile), hostile}}};
  Page page;
  page.title = hostile;
  page.lead = {{{Paragraph{plain(hostile)}}}};
  page.sections = {{"s", hostile, {{{figure, table, tiles}, hostile}, {{Items{{hostile}, {"s"}}}}}}};
  const std::string html = page_html(page);
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_EQ(count(html, "<script>"), 0);
  EXPECT_EQ(count(html, "<script"), 1);  // the figure's data
  EXPECT_EQ(count(html, "</script"), 1);
  EXPECT_EQ(count(html, "<img"), 0);
  EXPECT_EQ(html.find('\x01'), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::app::report
