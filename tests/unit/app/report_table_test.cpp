#include "app/report/table.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grainlaw::app::report {
namespace {

struct Fruit {
  std::string name;
  int count = 0;
  double mass = 0;
};
struct Basket {
  std::string owner;
  std::vector<Fruit> fruits;
};

const std::vector<Basket> kBaskets{
    {"A", {{"apple", 3, 0.123456}, {"pear", 0, std::nan("")}}}, {"B", {}}, {"C", {{"fig", 12, -2}}}};

TEST(ReportTable, AColumnSaysWhatItReadsOfAnEntry) {
  const Table table = table_of("Fruit", "fruit.json", kBaskets[0].fruits,
                               {{"name", Content::words, &Fruit::name},
                                {"{n}", Content::number, &Fruit::count},
                                {"mass [kg]", Content::number, [](auto& fruit) { return digits(fruit.mass, 3); }}});
  EXPECT_EQ(table.caption, "Fruit");
  EXPECT_EQ(table.source, "fruit.json");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(to_html(table.columns[1].heading), "<i>n</i>");
  EXPECT_EQ(table.columns[2].content, Content::number);
  ASSERT_EQ(table.rows.size(), 2U);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  EXPECT_EQ(to_html(table.rows[0][0].text), "apple");
  EXPECT_EQ(to_html(table.rows[0][1].text), "3");
  EXPECT_EQ(to_html(table.rows[0][2].text), "0.123");
  EXPECT_EQ(to_html(table.rows[1][2].text), kNoNumber);
}

TEST(ReportTable, ACellKeepsTheNumberBehindItsText) {
  EXPECT_TRUE(std::isnan(Cell("words").value));
  EXPECT_EQ(Cell(7).value, 7);
  EXPECT_EQ(digits(0.123456, 2).value, 0.123456);
  EXPECT_EQ(decimals(0.123456, 2).value, 0.123456);
  EXPECT_EQ(measured(8.2712, 0.31).value, 8.2712);
  EXPECT_EQ(to_html(measured(8.2712, 0.31).text), "8.27 ± 0.31");
}

TEST(ReportTable, EntriesWithinEntriesKeepTheirOwner) {
  std::string seen;
  for (const auto& entry : each_within(kBaskets, &Basket::fruits)) seen += entry.in.owner + ":" + entry.it.name + " ";
  EXPECT_EQ(seen, "A:apple A:pear C:fig ");
  const auto many = each_within(kBaskets, &Basket::fruits, [](auto& entry) { return entry.it.count > 5; });
  ASSERT_EQ(many.size(), 1U);
  EXPECT_EQ(many[0].in.owner, "C");
}

}  // namespace
}  // namespace grainlaw::app::report
