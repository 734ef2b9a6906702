#include "model/vocabulary/nearest_word.hpp"

#include <gtest/gtest.h>

namespace grainlaw {
namespace {

TEST(NearestWord, IsTheOneThatFewestEditsAreFrom) {
  const std::vector<std::string> known{"calibrate", "predict", "report", "stat", "study"};
  EXPECT_EQ(nearest_word("calibrat", known), "calibrate");   // one left out
  EXPECT_EQ(nearest_word("calirbate", known), "calibrate");  // two swapped: two edits
  EXPECT_EQ(nearest_word("predictt", known), "predict");     // one too many
  EXPECT_EQ(nearest_word("reprot", known), "report");
  EXPECT_EQ(nearest_word("studt", known), "study");             // one edit, "stat" is two away
  EXPECT_EQ(nearest_word("studs", {"stud", "study"}), "stud");  // the first of equals
}

TEST(NearestWord, IsNoneForWhatIsFarAndForShortWordsThatShareNothing) {
  EXPECT_EQ(nearest_word("xyzzy", {"calibrate", "study"}), "");
  EXPECT_EQ(nearest_word("nu", {"k", "xx"}), "");  // two letters changed of two
  EXPECT_EQ(nearest_word("", {"a", "ab"}), "");
  EXPECT_EQ(nearest_word(std::string(1000000, 'a'), {"a"}), "");
}

}  // namespace
}  // namespace grainlaw
