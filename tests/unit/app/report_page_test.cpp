#include "app/report/page.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <cmath>

#include "model/files/digest.hpp"
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

TEST(ReportPage, OnlyItsOwnScriptMayRun) {
  const std::string html = page_html({"title", {}, {}});
  EXPECT_EQ(test::first_markup_error(html), "");
  const std::size_t begin = html.find("<script>") + 8, end = html.find("</script>");
  const std::string script = html.substr(begin, end - begin);
  EXPECT_GT(script.size(), 5000u);
  EXPECT_LE(script.size(), 15360u);
  const std::size_t policy = html.find("script-src 'sha256-") + 19;
  const std::string digest = html.substr(policy, html.find('\'', policy) - policy);
  // base 64 by OpenSSL, of the script as it stands
  std::string expected(64, '\0');
  const std::string bytes = sha256_bytes(script);
  expected.resize(static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(expected.data()),
                                                           reinterpret_cast<const unsigned char*>(bytes.data()), 32)));
  EXPECT_EQ(digest, expected);
}

TEST(ReportPage, HeadingsOfAWideTableAreSaidBeforeItsCellsOnAPhone) {
  std::vector<TableColumn> columns(8, {notation("say \"{x}\" [–]")});
  const std::vector<Cell> row(8, Cell("twelve chars", 1.5));
  Table wide{"wide", columns, {row}, ""}, narrow{"narrow", {columns[0], columns[1]}, {{row[0], row[1]}}, ""};
  const std::string html = page_html({"title", {}, {{"s", "heading", {{{wide, narrow}}}}}});
  EXPECT_NE(html.find(" cards\">"), std::string::npos);
  EXPECT_EQ(html.find(" cards\">"), html.rfind(" cards\">")) << "the narrow one fits";
  EXPECT_NE(html.find("td:nth-child(8)::before { content: \"say \\22 x\\22  [–]\"; }"), std::string::npos);
}

TEST(ReportPage, LongWordsInHeadingsMakeATableWide) {
  const std::vector<TableColumn> columns(5, {notation("rehearsals of")});
  const std::vector<Cell> row(5, Cell("1", 1));
  Table wide{"wide", columns, {row}, ""}, narrow{"narrow", {columns[0]}, {{row[0]}}, ""};
  const std::string html = page_html({"title", {}, {{"s", "heading", {{{wide, narrow}}}}}});
  EXPECT_NE(html.find(" cards\">"), std::string::npos);
  EXPECT_EQ(html.find(" cards\">"), html.rfind(" cards\">")) << "the narrow one fits";
}

TEST(ReportPage, ItsNumbersAreToBeHadAsTheyAre) {
  Table table{"caption", {{notation("{x} [kg]")}, {plain("ratio [–]")}}, {{Cell("1.23", 1.23456789), "words"}}, "file"};
  table.notes = {"beneath"};
  Figure figure;
  figure.id = "f";
  Panel panel;
  panel.x.label = plain("t [s]");
  Series series;
  series.label = plain("line");
  series.x = {1, 2};
  series.y = {0.1234567890123, std::nan("")};
  series.bands = {{3, 4}};
  series.toggle = "t";
  panel.series = {series};
  figure.panels = {panel};
  const OrderedJson json = page_json({"title",
                                      {{{Tiles{"in short", {{plain("P"), plain("1 %"), "", 1.25}}}}}},
                                      {{"s", "heading", {{{table, figure}, "folded"}}}}});
  EXPECT_EQ(json["lead"][0]["tiles"][0]["value"], 1.25);
  const auto& contents = json["sections"][0]["contents"];
  EXPECT_EQ(contents[0]["columns"][0]["name"], "x");
  EXPECT_EQ(contents[0]["columns"][0]["unit"], "kg");
  EXPECT_EQ(contents[0]["columns"][1]["unit"], "");
  EXPECT_EQ(contents[0]["rows"][0][0]["value"], 1.23456789);
  EXPECT_EQ(contents[0]["rows"][0][0]["text"], "1.23");
  EXPECT_FALSE(contents[0]["rows"][0][1].contains("value"));
  EXPECT_EQ(contents[0]["notes"][0], "beneath");
  const auto& drawn = contents[1]["panels"][0]["series"][0];
  EXPECT_EQ(contents[1]["panels"][0]["x"]["unit"], "s");
  EXPECT_EQ(drawn["y"][0], 0.1234567890123);
  EXPECT_TRUE(drawn["y"][1].is_null());
  EXPECT_EQ(drawn["bands"][0][1], 4);
  EXPECT_EQ(drawn["toggle"], "t");
}

}  // namespace
}  // namespace grainlaw::app::report
