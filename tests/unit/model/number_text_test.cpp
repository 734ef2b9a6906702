#include "model/files/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace grainlaw {
namespace {

TEST(NumberText, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(number_of<int>("17"), 17);
  EXPECT_EQ(number_of<int>("-3"), -3);
  EXPECT_EQ(number_of<double>("1.5e-3"), 1.5e-3);
  for (const char* text : {"", " 1", "1 ", "1,5", "1.5x", "0x10", "+1", "--1", "1e400"})
    EXPECT_FALSE(number_of<double>(text)) << text;
  for (const char* text : {"", "1.0", "1e3", "2147483648", "-", "+1"}) EXPECT_FALSE(number_of<int>(text)) << text;
  EXPECT_FALSE(number_of<std::uint64_t>("-1"));
}

TEST(NumberText, TakesOneSignOnly) {
  EXPECT_EQ(decimal("+3.25"), 3.25);
  EXPECT_EQ(decimal("-3.25"), -3.25);
  EXPECT_TRUE(std::isinf(decimal("+inf").value_or(0)));
  for (const char* text : {"+", "+-3", "-+3", "++3", "+ 3", "--3"}) EXPECT_FALSE(decimal(text)) << text;
}

TEST(NumberText, TrimsBlanksAndTabs) {
  EXPECT_EQ(trimmed(" \t a b\t "), "a b");
  EXPECT_EQ(trimmed("a"), "a");
  EXPECT_EQ(trimmed(" \t "), "");
  EXPECT_EQ(trimmed(""), "");
}

}  // namespace
}  // namespace grainlaw
