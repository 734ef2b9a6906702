#include "app/report/page.hpp"

#include <gtest/gtest.h>

#include "tests/support/well_formed.hpp"

namespace grainlaw::app::report {
namespace {

TEST(ReportPage, ACellSaysItsNumberItsShadeAndWhereItLeads) {
  Cell shaded("2.8 %", 2.8);
  shaded.heat = 3;
  shaded.link = "there";
  Cell barred("ours 1", 1);
  barred.bar = Bar{0.5, 1, 1.5, kUndefined};
  Table table{
      "caption", {{plain("a"), Content::words}, {plain("b")}, {plain("c")}}, {{Cell("row"), shaded, barred}}, ""};
  table.notes = {"beneath"};
  table.id = "table-id";
  table.bar_from = 0;
  table.bar_to = 2;
  const std::string html = page_html({"title", {}, {{"s", "heading", {{{table}}}}}});
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_NE(html.find("<td class=\"number heat3\" data-value=\"2.8\"><a href=\"#there\">2.8 %</a></td>"),
            std::string::npos);
  EXPECT_NE(html.find("id=\"table-id\""), std::string::npos);
  EXPECT_NE(html.find("<tr class=\"note\"><td colspan=\"3\">beneath</td></tr>"), std::string::npos);
  // 0 to 2 are 200 px: from .5 to 1.5 with the dot between
  EXPECT_NE(html.find("d=\"M50.0 8H150.0\""), std::string::npos);
  EXPECT_NE(html.find("cx=\"100.0\""), std::string::npos);
  EXPECT_EQ(html.find("data-value"), html.find("data-value=\"2.8\"")) << "words have none";
}

}  // namespace
}  // namespace grainlaw::app::report
