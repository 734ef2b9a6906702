#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "app/report/page.hpp"
#include "app/report/page_figure.hpp"
#include "app/report/svg_figure.hpp"
#include "tests/support/svg_path.hpp"
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

/// All panels of a figure.
std::string svg_of(const Figure& figure) {
  std::string svg;
  for (const std::string& panel : render(figure).panels) svg += panel;
  return svg;
}

TEST(ReportFigure, UndefinedPointsAreCountedAndBreakTheLine) {
  const double nan = std::nan("");
  const Figure figure = one_panel(line_of({0, 1, 2, 3, 4, INFINITY}, {0, 1, nan, 3, 4, 5}));
  const std::string svg = svg_of(figure);
  EXPECT_EQ(render(figure).undefined_points, 2);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(test::first_markup_error(svg), "");
  const auto line = test::corners_of(test::path_data(svg, "l")), symbols = test::corners_of(test::path_data(svg, "m"));
  ASSERT_EQ(line.size(), 2u) << "one piece on either side of the gap";
  EXPECT_EQ(line[0].size(), 2u);
  EXPECT_EQ(line[1].size(), 2u);
  ASSERT_EQ(symbols.size(), 1u);
  EXPECT_EQ(symbols[0].size(), 4u);
  EXPECT_EQ(count(svg, "<marker "), 1) << "the symbol is drawn once";
}

TEST(ReportFigure, BandsStretchTheAxisAndBreakWhereTheyAreUndefined) {
  Series series = line_of({0, 1, 2, 3, 4}, {1, 1, 1, 1, 1});
  EXPECT_EQ(count(svg_of(one_panel(series)), "class=\"b\""), 0);
  series.bands = {{5, 5, std::nan(""), 5, 5}, {1, 1, 1, 1, 1}};
  const std::string svg = svg_of(one_panel(series));
  EXPECT_EQ(count(svg, "class=\"b\""), 2);
  const auto pieces = test::corners_of(test::path_data(svg, "b"));
  ASSERT_EQ(pieces.size(), 2u) << "one piece on either side of the gap";
  for (const test::Corners& piece : pieces) EXPECT_EQ(piece.size(), 4u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(render(one_panel(series)).undefined_points, 0) << "the points themselves are";
  // an axis from 0 to 2 would not reach the band's edge, 6
  EXPECT_NE(svg.find(">6<"), std::string::npos);
}

TEST(ReportFigure, ALineIsSimplifiedToWhatAPixelShows) {
  Series straight = line_of({}, {}), curved = line_of({}, {});
  straight.marker = curved.marker = Marker::none;
  for (int i = 0; i <= 1000; ++i) {
    const double x = 1e-3 * i;
    straight.x.push_back(x);
    straight.y.push_back(2 * x);
    curved.x.push_back(x);
    curved.y.push_back(std::sin(20 * x));
  }
  EXPECT_EQ(test::corners_of(test::path_data(svg_of(one_panel(straight)), "l"))[0].size(), 2u);
  const Figure figure = one_panel(curved);
  const Frame frame = render(figure).frames[0];
  const test::Corners corners = test::corners_of(test::path_data(svg_of(figure), "l"))[0];
  EXPECT_LT(corners.size(), 200u);
  std::size_t at = 0;
  for (std::size_t i = 0; i < curved.x.size(); ++i) {  // every point is within 0.2 px and rounding of what is drawn
    const double x = frame.px(curved.x[i]), y = frame.py(curved.y[i]);
    while (at + 2 < corners.size() && corners[at + 1][0] < x) ++at;
    const auto &a = corners[at], &b = corners[at + 1];
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    EXPECT_LT(std::abs((x - a[0]) * dy - (y - a[1]) * dx) / std::hypot(dx, dy), 0.3) << i;
  }
}

TEST(ReportFigure, PathsSayPlacesToATenthOfAPixel) {
  Series series = line_of({0, 0.1, 0.35, 0.351, 1}, {0, 3, -2, 5, 1e-3});
  const Figure figure = one_panel(series);
  const Frame frame = render(figure).frames[0];
  const auto symbols = test::corners_of(test::path_data(svg_of(figure), "m"));
  ASSERT_EQ(symbols.size(), 1u);
  ASSERT_EQ(symbols[0].size(), series.x.size());
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    EXPECT_NEAR(symbols[0][i][0], frame.px(series.x[i]), 0.0501) << i;
    EXPECT_NEAR(symbols[0][i][1], frame.py(series.y[i]), 0.0501) << i;
  }
}

std::vector<double> unpacked(const std::string& json) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const Json packed = Json::parse(json);
  const double lowest = packed[0], highest = packed[1];
  const std::string text = packed[2];
  std::vector<double> values;
  for (std::size_t i = 0; i + 2 < text.size(); i += 3) {
    const std::size_t code =
        alphabet.find(text[i]) * 4096 + alphabet.find(text[i + 1]) * 64 + alphabet.find(text[i + 2]);
    values.push_back(code == 262143 ? std::nan("") : lowest + (highest - lowest) * static_cast<double>(code) / 262142);
  }
  return values;
}

TEST(ReportFigure, PackedNumbersKeepFiveDigitsOfTheirRange) {
  const std::vector<double> values{-3, 7.25, 1e-9, 2, INFINITY, 5};
  const std::vector<double> back = unpacked(packed_numbers(values, false));
  ASSERT_EQ(back.size(), values.size());
  for (const std::size_t i : {0u, 1u, 2u, 3u, 5u}) EXPECT_NEAR(back[i], values[i], 0.51 * 10.25 / 262142) << i;
  EXPECT_TRUE(std::isnan(back[4]));
  const std::vector<double> logarithms = unpacked(packed_numbers({1e-9, 0, 1e3, -1}, true));
  EXPECT_NEAR(std::exp(logarithms[0]), 1e-9, 1e-13);
  EXPECT_NEAR(std::exp(logarithms[2]), 1e3, 0.1);
  EXPECT_TRUE(std::isnan(logarithms[1]) && std::isnan(logarithms[3]));
  const Json wide = Json::parse(packed_numbers({6.4e-8, NAN, 0.1}, false));
  ASSERT_EQ(wide.size(), 4U) << "P* at jamming";
  EXPECT_NEAR(std::exp(unpacked(wide.dump())[0]) / 6.4e-8, 1, 1e-4);
  EXPECT_TRUE(std::isnan(unpacked(wide.dump())[1]));
  EXPECT_EQ(Json::parse(packed_numbers({0, 1, 1000}, false)).size(), 3U);
  EXPECT_EQ(unpacked(packed_numbers({4, 4}, false)), (std::vector<double>{4, 4}));
  EXPECT_EQ(packed_numbers({}, false), "[0,0,\"\"]");
  EXPECT_EQ(packed_numbers({std::nan("")}, false), "[0,0,\"///\"]");
  EXPECT_TRUE(std::isfinite(unpacked(packed_numbers({-1e308, 1e308}, false))[1]));
}

TEST(ReportFigure, SeriesHangOnToTheirToggles) {
  Figure figure = one_panel(line_of({0, 1}, {0, 1}));
  auto& series = figure.panels[0].series;
  series.push_back(series[0]);
  series[1].label = plain("other");
  series[1].toggle = "other";
  series[1].initially_hidden = true;
  for (const char* label : {"DEM", "DEM, line"}) {
    series.push_back(series[0]);
    series.back().label = plain(label);
    series.back().toggle = "seed 3";
  }
  const std::string html = figure_html(figure);
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_EQ(count(html, "<input type=\"checkbox\" class=\"c0\"/>"), 1) << "off at first";
  EXPECT_EQ(count(html, "<input type=\"checkbox\" class=\"c1\" checked=\"checked\"/>seed 3"), 1) << "of two labels";
  EXPECT_EQ(count(html, "<g class=\"s k0 t0\">"), 1);
  EXPECT_EQ(count(html, "<g class=\"s k0 t1\">"), 2);
  EXPECT_EQ(count(html, "<g class=\"s k0\">"), 1);
  EXPECT_NE(toggle_style(2).find("figure:has(.c1:not(:checked)) .t1 { display: none; }"), std::string::npos);
  EXPECT_EQ(figure_svg(figure).find("other"), std::string::npos) << "a file shows what is shown at first";
}

TEST(ReportFigure, ALogarithmicAxisLeavesOutWhatIsNotPositive) {
  Figure figure = one_panel(line_of({0, 1, 2, 3}, {1e-3, 0, -1, 1e-1}));
  figure.panels[0].y.logarithmic = true;
  EXPECT_EQ(render(figure).undefined_points, 2);
}

TEST(ReportFigure, SymbolsBeyondAFixedRangeAreCounted) {
  Figure figure = one_panel(line_of({0, 1, 2, 3}, {0, 1, 2, 300}));
  figure.panels[0].y.from = 0;
  figure.panels[0].y.to = 2;
  EXPECT_EQ(render(figure).outside_points, 1);
}

TEST(ReportFigure, NothingToDrawIsStillAFigure) {
  for (const bool logarithmic : {false, true}) {
    Figure figure = one_panel(line_of({}, {}));
    figure.panels[0].y.logarithmic = logarithmic;
    EXPECT_EQ(test::first_markup_error(figure_svg(figure)), "");
    EXPECT_EQ(test::first_markup_error(figure_html(figure)), "");
  }
  Figure none;
  none.id = "none";
  EXPECT_EQ(test::first_markup_error(figure_svg(none)), "");
  EXPECT_EQ(test::first_markup_error(figure_html(none)), "");
}

TEST(ReportFigure, EnormousNumbersStayFinite) {
  const std::string html = figure_html(one_panel(line_of({0, 1, 2}, {-1e308, 1e308, 1e-308})));
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
}

TEST(ReportFigure, PanelsShareAxesOnRequest) {
  Figure figure = one_panel(line_of({0, 1}, {0, 1}));
  figure.panels.push_back(figure.panels[0]);
  figure.panels[1].series[0].y = {0, 10};
  figure.columns = 2;
  figure.shared_axes = true;
  const RenderedFigure rendered = render(figure);
  for (const std::string& panel : rendered.panels)
    EXPECT_EQ(count(panel, ">10</text>"), 1) << "each panel can stand by itself";
  EXPECT_EQ(count(figure_svg(figure), ">line</text>"), 1);  // one entry in the legend
  figure.shared_axes = false;
  EXPECT_EQ(count(render(figure).panels[0], ">10</text>"), 0);
}

// A symbol lies at the same height in every one of many panels.
TEST(ReportFigure, DataStayInTheirPanelHoweverFarDown) {
  Series series = line_of({0, 1}, {0, 1});
  series.line = Line::none;
  Figure figure = one_panel(series);
  figure.panels.assign(30, figure.panels[0]);
  figure.columns = 1;
  const RenderedFigure rendered = render(figure);
  ASSERT_EQ(rendered.panels.size(), 30u);
  for (const std::string& panel : rendered.panels)
    EXPECT_EQ(test::path_data(panel, "m"), test::path_data(rendered.panels[0], "m"));
  // and in a file they stand below each other, each a panel's height further down
  const std::string svg = figure_svg(figure), height = fmt::format("{:g}", rendered.height);
  EXPECT_EQ(count(svg, "height=\"" + height + "\""), 30);
  EXPECT_NE(svg.find(fmt::format("y=\"{:g}\" width", 24 + 29 * rendered.height)), std::string::npos);
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
  EXPECT_EQ(count(html, "<script>"), 1);  // the page's own
  EXPECT_EQ(count(html, "<script"), 2);   // and the figure's data
  EXPECT_EQ(count(html, "</script"), 2);
  EXPECT_EQ(count(html, "<img"), 0);
  EXPECT_EQ(html.find('\x01'), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::app::report
