#include "app/report/series.hpp"

#include <gtest/gtest.h>

#include "tests/support/report_scene.hpp"

namespace grainlaw::app::report {
namespace {

TestRecord test_of_rows(int count) {
  TestRecord test;
  for (int i = 0; i < count; ++i) {
    Observation row;
    row.eps_dev = i;
    row.P_star = 2 * i;
    test.rows.push_back(row);
  }
  return test;
}

TEST(ReportSeries, PointsAreReadOfTheEntriesThatAreKept) {
  const Series style = open_symbols(plain("label"), Colour::green, Marker::diamond, 2);
  const Series series = through(
      style, test_of_rows(4).rows, &Observation::eps_dev, [](const Observation& row) { return row.P_star + 1; },
      [](const Observation& row) { return row.eps_dev != 2; });
  EXPECT_EQ(series.x, (std::vector<double>{0, 1, 3}));
  EXPECT_EQ(series.y, (std::vector<double>{1, 3, 7}));
  EXPECT_EQ(series.colour, Colour::green);
  EXPECT_TRUE(series.open_marker);
  EXPECT_EQ(series.line, Line::none);
}

TEST(ReportSeries, ACurveTouchesBothEnds) {
  const Series series = curve(
      line_of(plain("y"), Colour::ink, Line::dashed), -1, 3, [](double x) { return x * x; }, 4);
  EXPECT_EQ(series.x, (std::vector<double>{-1, 0, 1, 2, 3}));
  EXPECT_EQ(series.y, (std::vector<double>{1, 0, 1, 4, 9}));
}

TEST(ReportSeries, RowsAreThinnedEvenlyAndALineEndsWithTheLast) {
  for (const int count : {0, 1, 59, 60, 61, 119, 1000}) {
    const TestRecord test = test_of_rows(count);
    const auto symbols = symbol_rows(test, 60), line = line_rows(test);
    EXPECT_LE(symbols.size(), 60U);
    EXPECT_LE(line.size(), 121U);
    if (count == 0) continue;
    EXPECT_EQ(symbols.front().eps_dev, 0);
    EXPECT_EQ(line.back().eps_dev, count - 1);
    for (std::size_t i = 2; i < symbols.size(); ++i)
      EXPECT_EQ(symbols[i].eps_dev - symbols[i - 1].eps_dev, symbols[1].eps_dev - symbols[0].eps_dev);
  }
}

TEST(ReportSeries, ACurveOfTheLawIsKnownWhenAllThatItReadsIs) {
  CalibratedLaw law = test::report_scene().calibration.law;
  EXPECT_TRUE(has_values(law, density_curve("P_star")));
  law.estimates[parameter_index("rattlers.phi_c")].status = Status::not_identified;
  EXPECT_FALSE(has_values(law, density_curve("P_star"))) << "P* reads C through the rattlers";
  EXPECT_TRUE(has_values(law, density_curve("C_star")));
}

}  // namespace
}  // namespace grainlaw::app::report
