#include "chain/studies/spec_settings.hpp"

#include <gtest/gtest.h>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

TEST(KeyChanges, ValuesAreNumbersListsOrText) {
  EXPECT_EQ(change_from("strain_rate=69").second, Json(69));
  EXPECT_EQ(change_from("densities=[0.7, 0.8]").second, Json::parse("[0.7, 0.8]"));
  EXPECT_EQ(change_from("precision=double"), (std::pair{std::string("precision"), Json("double")}));
  EXPECT_EQ(change_from("comment=a=b").second, Json("a=b"));
  EXPECT_EQ(change_from("densities=[0.7,").second, Json("[0.7,"));  // no list: SPEC refuses it
  for (const char* bad : {"strain_rate", "=3", "strain_rate="}) EXPECT_THROW(change_from(bad), InvalidInput) << bad;
}

TEST(KeyChanges, LeadIntoWhatIsThere) {
  const Json base = Json::parse(R"({"rows": 40, "tests": [{"mode": "ISO"}, {"mode": "D2", "strain": 0.3}]})");
  const Json after = changed(base, {{"rows", 20}, {"skin", 0.5}, {"tests[1].strain", 0.2}}, "x");
  EXPECT_EQ(after["rows"], 20);
  EXPECT_EQ(after["skin"], 0.5);
  EXPECT_EQ(after["tests"], Json::parse(R"([{"mode": "ISO"}, {"mode": "D2", "strain": 0.2}])"));
  for (const char* bad : {"tests[2].strain", "tests[1]", "tests[x].strain", "tests[-1].strain", "tests.strain",
                          "other.strain", "rows.strain", "tests[01].strain", "~"})
    EXPECT_THROW(changed(base, {{bad, 1}}, "x"), InvalidInput) << bad;
}

}  // namespace
}  // namespace grainlaw::chain
